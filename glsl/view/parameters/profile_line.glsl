// view/parameters/profile_line.glsl -- the line along which a profile is taken.
//
//   gives    start, finish
//   needs    nothing
//   units    shares of the terrain, 0..1
//   source   none: parameters
//   tested   tests/glsl/test_view_profile.py
#ifndef VIEW_PARAMETERS_PROFILE_LINE
#define VIEW_PARAMETERS_PROFILE_LINE
uniform vec2 start = vec2(0.1, 0.5);   //! point group("Line") Where the line begins
uniform vec2 finish = vec2(0.9, 0.5);  //! point group("Line") Where it ends
#endif
