// trees/parameters/species.glsl -- how many trees have needles, and which season it is.
//
//   gives    needles, needles_from
//   needs    nothing
//   units    shares 0..1; metres above sea level
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_SPECIES
#define TREES_PARAMETERS_SPECIES
uniform float needles = 0.12;         //! slider(0, 1) step(0.01) group("Species")
                                      //! Share of trees with needles
uniform float needles_from = 9000.0;  //! slider(0, 9000) unit("m") group("Species")
                                      //! Above sea level: higher, all trees have needles
#endif
