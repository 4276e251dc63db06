// view/parameters/layers.glsl -- how four tiles lie on the terrain, and how they mix.
//
//   gives    grass_repeats, rock_repeats, snow_repeats, path_repeats, blend, contrast
//   needs    nothing
//   units    how often a tile repeats from west to east
//   source   Belaiche 2010, section 2.5; by heights: see texturing/splat/mix.glsl
//   tested   tests/glsl/test_splat_view.py
#ifndef VIEW_PARAMETERS_LAYERS
#define VIEW_PARAMETERS_LAYERS
uniform float grass_repeats = 48.0;   //! slider(1, 512) step(1) group("Layers")
                                      //! How often its tile repeats from west to east
uniform float rock_repeats = 48.0;    //! slider(1, 512) step(1) group("Layers")
                                      //! How often its tile does
uniform float snow_repeats = 48.0;    //! slider(1, 512) step(1) group("Layers")
                                      //! How often its tile does
uniform float path_repeats = 48.0;    //! slider(1, 512) step(1) group("Layers")
                                      //! How often its tile does
uniform int blend = 0;                //! menu("even", "by heights") group("Layers")
                                      //! How materials mix where they meet: as in a mist, or what
                                      //! is higher comes through
uniform float contrast = 6.0;         //! slider(0, 20) step(0.1) group("Layers")
                                      //! How strictly heights decide; 0 is even
#endif
