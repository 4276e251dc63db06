// erosion/thermal/start.glsl -- the terrain on this grid, and what slid on a coarser one.
//
//   gives    ground, with what slid; before, without
//   needs    maths/land.glsl, terrain/heightfield.glsl; a height, and of the coarser grid both
//            that this gives
//   units    heights in units of relief
//   source   Brandt 1977, "Multi-Level Adaptive Solutions to Boundary-Value Problems":
//            corrections go from a coarse grid to a fine one, not the solution itself
//   tested   tests/glsl/test_thermal.py, by the volume
//
// Between the coarse grid's nodes what slid is interpolated, which keeps the volume below the
// mesh where a coarse texel is two fine ones (sizes k 2^n + 1).
#include "terrain/heightfield.glsl"
#pragma kernel(output = "ground:r32f, before:r32f")

uniform sampler2D height;         //! input
uniform sampler2D slid;           //! input("zero")
uniform sampler2D coarse_before;  //! input("zero")

uniform bool coarse = true;  //! Whether it begins on coarse grids, where few steps go far

void kernel(ivec2 texel, out float ground, out float before) {
    before = height_at(height, place_on(textureSize(height, 0), texel, size));
    // anchor: coarse
    vec2 place = place_on(textureSize(slid, 0), texel, size);
    ground = before + (height_at(slid, place) - height_at(coarse_before, place));
    // end: coarse
}
