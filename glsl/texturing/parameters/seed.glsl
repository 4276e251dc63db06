// texturing/parameters/seed.glsl -- which of many tiles is made.
//
//   gives    seed
//   needs    nothing
//   units    a number
//   source   none: a parameter
//   tested   tests/glsl/test_base_textures.py
#ifndef TEXTURING_PARAMETERS_SEED
#define TEXTURING_PARAMETERS_SEED
uniform uint seed = 1u;  //! slider(0, 9999) Which tile
#endif
