// water/least_fall.glsl -- the fall that standing water is given, so that it has a way to go.
//
//   gives    least_fall, falls_between
//   needs    nothing: pure functions, no uniforms, no textures
//   units    height without unit, per metre
//   source   Planchon and Darboux 2002, section 2.1; the rounding derived here
//   tested   tests/glsl/test_fill.py: every texel of a flat terrain drains
//
// A tenth of a millimetre in a metre; but from texel to texel never so little that a float of a
// height up to 8 would be rounded to the one before.
#ifndef WATER_LEAST_FALL
#define WATER_LEAST_FALL

float least_fall(vec2 spacing, float relief) {
    return max(1e-4 / max(relief, 1e-3), 1e-6 / min(spacing.x, spacing.y));
}

// From a texel to its neighbours: along x, along y and diagonally.
vec3 falls_between(vec2 spacing, float relief) {
    return least_fall(spacing, relief) * vec3(spacing, length(spacing));
}
#endif
