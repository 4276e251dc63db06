// view/parameters/adapts.glsl -- whether the picture itself says how bright it is shown.
//
//   gives    adapts
//   needs    nothing
//   units    see there
//   source   none: a parameter
//   tested   tests/glsl/test_after.py
#ifndef VIEW_PARAMETERS_ADAPTS
#define VIEW_PARAMETERS_ADAPTS
uniform bool adapts = false;  //! group("Picture")
                              //! Exposure by the picture's own mean light, before `exposure`
#endif
