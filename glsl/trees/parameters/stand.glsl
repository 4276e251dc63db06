// trees/parameters/stand.glsl -- the trees that trees/place draws, for what shows their mean.
//
//   gives    cell, tallest, shortest
//   needs    trees/parameters/cell.glsl
//   units    metres
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_STAND
#define TREES_PARAMETERS_STAND
#include "trees/parameters/cell.glsl"
uniform float tallest = 21.0;   //! log_slider(0.1, 100) unit("m") Height of the tallest trees
uniform float shortest = 0.55;  //! slider(0.1, 1) step(0.01)
                                //! Height of the shortest, as a share of that
#endif
