// trees/parameters/species.glsl -- how many trees have needles, low down and high up.
//
//   gives    needles, needles_from
//   needs    trees/parameters/needles.glsl
//   units    shares 0..1; metres above sea level
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_SPECIES
#define TREES_PARAMETERS_SPECIES
#include "trees/parameters/needles.glsl"
uniform float needles_from = 9000.0;  //! slider(0, 9000) unit("m") group("Species")
                                      //! Above sea level: higher, all trees have needles
#endif
