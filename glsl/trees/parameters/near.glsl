// trees/parameters/near.glsl -- up to where trees are meshes.
//
//   gives    near
//   needs    nothing
//   units    metres
//   source   none
//   tested   tests/glsl/test_trees_near.py
#ifndef TREES_PARAMETERS_NEAR
#define TREES_PARAMETERS_NEAR
uniform float near = 160.0;  //! slider(0, 250) unit("m")
                           //! Nearer than this, trees have leaves; whole at half of it
#endif
