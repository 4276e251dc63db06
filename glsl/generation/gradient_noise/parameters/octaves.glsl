// generation/gradient_noise/parameters/octaves.glsl -- what a sum of octaves is told.
//
//   gives    basis, shape, octaves, frequency, lacunarity, gain, warp, seed
//   needs    nothing
//   units    as each says
//   source   see noise/octaves.glsl
//   tested   tests/glsl/test_gradient_noise.py, with what reads them
#ifndef GENERATION_GRADIENT_NOISE_PARAMETERS_OCTAVES
#define GENERATION_GRADIENT_NOISE_PARAMETERS_OCTAVES
uniform int basis = 0;           //! menu("Perlin", "simplex") On a lattice of squares or of
                                 //! triangles
uniform int shape = 0;           //! menu("plain", "ridged", "billow", "warped") The sum itself;
                                 //! sharp ridges; soft hills between creases; a sum bent by two
                                 //! others
uniform int octaves = 6;         //! slider(0, 16) Sums of noise; those too fine for the texels are
                                 //! left out
uniform float frequency = 4.0;   //! log_slider(0.25, 1024) Cells along the terrain's width in the
                                 //! first octave
uniform float lacunarity = 2.0;  //! slider(1.1, 4) step(0.05) Cells of an octave to one of the
                                 //! octave before
uniform float gain = 0.5;        //! slider(0, 1) step(0.01) Strength of an octave over the one
                                 //! before, also called persistence
uniform float warp = 0.4;        //! slider(0, 2) step(0.01) Warped: how far a place is moved, in
                                 //! cells of the first octave
uniform uint seed = 7u;          //! slider(0, 9999) Which terrain
#endif
