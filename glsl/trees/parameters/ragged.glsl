// trees/parameters/ragged.glsl -- how ragged crowns are.
//
//   gives    ragged
//   needs    nothing
//   units    none
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_RAGGED
#define TREES_PARAMETERS_RAGGED
uniform float ragged = 1.0;  //! slider(0, 1.5) step(0.01) group("Species") How ragged crowns are
#endif
