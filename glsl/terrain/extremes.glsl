// terrain/extremes.glsl -- the lowest and the highest of numbers seen one after the other.
//
//   gives    NO_RANGE, widened
//   needs    nothing: pure functions, no uniforms, no textures
//   units    any
//   source   derived here
//   tested   tests/glsl/test_normalise.py, against NumPy
#ifndef TERRAIN_EXTREMES
#define TERRAIN_EXTREMES

// Lowest and highest of no number at all.
const vec2 NO_RANGE = vec2(3.4e38, -3.4e38);

// A range, made to hold another. Written as comparisons, because those are false for a
// number that is none: GLSL's min and max may return it or not, as the driver likes.
vec2 widened(vec2 range, vec2 other) {
    return vec2(other.x < range.x ? other.x : range.x, other.y > range.y ? other.y : range.y);
}
#endif
