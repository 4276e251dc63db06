// objects/parameters/shade.glsl -- how wide the square of rocks' shadows around the eye is.
//
//   gives    rock_shade_wide
//   needs    nothing
//   units    metres
//   source   none
//   tested   tests/glsl/test_undergrowth.py
#ifndef OBJECTS_PARAMETERS_SHADE
#define OBJECTS_PARAMETERS_SHADE
uniform float rock_shade_wide = 300.0;  //! log_slider(10, 4000) unit("m")
                                        //! Side of the square around the eye with shadows of rocks
#endif
