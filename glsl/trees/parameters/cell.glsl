// trees/parameters/cell.glsl -- the lattice on which trees/place draws trees.
//
//   gives    cell
//   needs    nothing
//   units    metres
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_CELL
#define TREES_PARAMETERS_CELL
uniform float cell = 9.0;       //! log_slider(0.1, 100) unit("m")
                                //! Side of a cell: at most one tree in each
#endif
