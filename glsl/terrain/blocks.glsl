// terrain/blocks.glsl -- square blocks of texels, for what is known about each as a whole.
//
//   gives    BLOCK_SHIFT
//   needs    nothing
//   units    texels
//   source   none: a number
//   tested   tests/glsl/test_shadows.py, by block maxima against NumPy
#ifndef TERRAIN_BLOCKS
#define TERRAIN_BLOCKS

const int BLOCK_SHIFT = 4;  // a block has 1 << 4 = 16 texels a side
#endif
