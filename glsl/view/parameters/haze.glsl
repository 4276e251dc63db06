// view/parameters/haze.glsl -- the air before the terrain.
//
//   gives    haze, horizon
//   needs    nothing
//   units    colours linear
//   source   none: parameters
//   tested   tests/glsl/test_view.py
#ifndef VIEW_PARAMETERS_HAZE
#define VIEW_PARAMETERS_HAZE
uniform float haze = 0.0;                       //! slider(0, 2) step(0.01) group("Sky")
                                                //! Air between the eye and the terrain: how much a
                                                //! terrain's width of it takes away
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);  //! colour group("Sky") The haze's colour
#endif
