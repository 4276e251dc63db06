// view/parameters/earth.glsl -- the colour of the terrain's cut.
//
//   gives    earth
//   needs    nothing
//   units    linear
//   source   none: a parameter
//   tested   tests/glsl/test_view.py
#ifndef VIEW_PARAMETERS_EARTH
#define VIEW_PARAMETERS_EARTH
uniform vec3 earth = vec3(0.135, 0.10, 0.075);  //! colour group("Mesh") The cut earth's colour
#endif
