// water/levels/parameters/keep.glsl -- how much of a given terrain rivers begin with.
//
//   gives    the parameter keep
//   needs    nothing
//   units    a share
//   source   none: made here
//   tested   tests/glsl/test_stream_power.py
#ifndef WATER_LEVELS_PARAMETERS_KEEP
#define WATER_LEVELS_PARAMETERS_KEEP
uniform float keep = 0.1;  //! slider(0, 1) step(0.01) Share of the given heights that it begins
                           //! with; the edges stay so
#endif
