// trees/parameters/budget.glsl -- how many trees a picture has at most.
//
//   gives    trees
//   needs    nothing
//   units    trees
//   source   none
//   tested   tests/glsl/test_trees.py
#ifndef TREES_PARAMETERS_BUDGET
#define TREES_PARAMETERS_BUDGET
uniform int trees = 65536;  //! slider(256, 524288) step(256) preview(24576)
                            //! How many trees are drawn at most: where there are more, fewer of
                            //! them are kept at every distance
#endif
