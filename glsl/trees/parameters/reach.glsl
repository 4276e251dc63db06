// trees/parameters/reach.glsl -- how far from the eye trees are drawn, and how far all of them.
//
//   gives    whole, reach
//   needs    nothing
//   units    metres
//   source   none
//   tested   tests/glsl/test_trees.py
#ifndef TREES_PARAMETERS_REACH
#define TREES_PARAMETERS_REACH
uniform float whole = 1700.0;  //! log_slider(10, 10000) unit("m")
                               //! Nearer than this no tree is left out
uniform float reach = 4800.0;  //! log_slider(50, 20000) unit("m")
                               //! Where single trees end, no more than 1024 cells away:
                               //! beyond, they colour the ground
#endif
