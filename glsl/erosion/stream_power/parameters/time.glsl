// erosion/stream_power/parameters/time.glsl -- how long a terrain rises, and in how many steps.
//
//   gives    the parameters age, steps, finer_steps
//   needs    nothing
//   units    years are millions
//   source   none: made here
//   tested   tests/glsl/test_stream_power.py
#ifndef EROSION_STREAM_POWER_PARAMETERS_TIME
#define EROSION_STREAM_POWER_PARAMETERS_TIME
uniform float age = 4.0;      //! log_slider(0.01, 100) unit("Myr") How long it has been rising
uniform int steps = 40;       //! slider(1, 400) Steps in which that is done, on the coarsest level
uniform int finer_steps = 8;  //! slider(1, 100) Further steps on each finer level, each as long
uniform int coarsest = 16;    //! slider(8, 4096) Spacings of the coarsest level along the shorter
                              //! side, or up to twice as many
#endif
