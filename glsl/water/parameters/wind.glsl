// water/parameters/wind.glsl -- the wind over the water.
//
//   gives    wind, wind_to, fetch
//   needs    nothing
//   units    metres a second, degrees, metres
//   source   none: parameters
//   tested   tests/glsl/test_scene_water.py
#ifndef WATER_PARAMETERS_WIND
#define WATER_PARAMETERS_WIND
uniform float wind = 3.0;         //! slider(0, 25) step(0.1) unit("m/s") group("Water")
                                  //! Wind over the water: the more, the rougher; 0 is a mirror
uniform float wind_to = 60.0;     //! angle group("Water") Where it blows, clockwise from north
uniform float fetch = 4000.0;     //! log_slider(10, 1000000) unit("m") group("Water")
                                  //! How far it blows over water: the farther, the longer waves
#endif
