// trees/parameters/shade.glsl -- how wide the square of tree shadows around the eye is.
//
//   gives    shade_wide
//   needs    nothing
//   units    metres
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_SHADE
#define TREES_PARAMETERS_SHADE
uniform float shade_wide = 4000.0;  //! log_slider(100, 20000) unit("m")
                                    //! Side of the square around the eye with shadows of trees
#endif
