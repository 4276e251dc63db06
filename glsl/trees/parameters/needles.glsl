// trees/parameters/needles.glsl -- how many trees of the lowland have needles.
//
//   gives    needles
//   needs    nothing
//   units    share 0..1
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_NEEDLES
#define TREES_PARAMETERS_NEEDLES
uniform float needles = 0.12;  //! slider(0, 1) step(0.01) group("Species")
                               //! Share of trees with needles
#endif
