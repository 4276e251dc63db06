// scene/surfaces.glsl -- which surface a pixel of the scene sees, by the fourth number of `seen`.
//
//   gives    SKY, TOP, CUT, WATER, BROKEN_GROUND, packed_cut, depth_of_cut, is_sky, is_top,
//            is_cut, is_water, is_broken, is_object
//   needs    scene/packing.glsl: pure functions, no uniforms, no textures
//   units    depths of the cut 0..1
//   source   none: made here
//   tested   tests/glsl/test_scene.py
//
// It is 0 for the sky, 1 for the terrain's top, from 2 and below 3 for its cut (the fraction says
// how far down), 3 for water, below 0 for terrain that is no number, and from 4 on an object.
#ifndef SCENE_SURFACES
#define SCENE_SURFACES
#include "scene/packing.glsl"

const float BROKEN_GROUND = -1.0;
const float SKY = 0.0;
const float TOP = 1.0;
const float CUT = 2.0;
const float WATER = 3.0;
const float DEEPEST = 0.96875;  // of a cut: below 1, and whole in half floats too

bool is_broken(float number) { return number < SKY; }
bool is_sky(float number) { return number == SKY; }
bool is_top(float number) { return number == TOP; }
bool is_cut(float number) { return number >= CUT && number < WATER; }
bool is_water(float number) { return number == WATER; }
bool is_object(float number) { return number >= FIRST_OBJECT; }

// The cut at a depth from 0 on the terrain to 1 at its foot.
float packed_cut(float depth) { return CUT + DEEPEST * clamp(depth, 0.0, 1.0); }
float depth_of_cut(float number) { return (number - CUT) / DEEPEST; }
#endif
