// scene/water/moment_texels.glsl -- where in the table of scene/water/moment what is.
//
//   gives    DRIFT, WOOD, TILES
//   needs    nothing
//   units    texels
//   source   none
//   tested   tests/glsl/test_scene_water.py
#ifndef SCENE_WATER_MOMENT_TEXELS
#define SCENE_WATER_MOMENT_TEXELS
const ivec2 DRIFT = ivec2(0, 2);  // of the clouds
const ivec2 WOOD = ivec2(1, 2);   // the colour of leaves
const ivec2 TILES = ivec2(2, 2);  // the mean colour of the first of four tiles
#endif
