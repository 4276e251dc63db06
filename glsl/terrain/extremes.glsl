// terrain/extremes.glsl -- the lowest and the highest of numbers seen one after the other.
//
//   gives    NO_RANGE, widened, span_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    any
//   source   derived here; a sum of n terms is off by at most n half steps of a float, as in
//            Higham 2002, "Accuracy and Stability of Numerical Algorithms", section 4.2
//   tested   tests/glsl/test_filters.py, against NumPy
#ifndef TERRAIN_EXTREMES
#define TERRAIN_EXTREMES

// Lowest and highest of no number at all.
const vec2 NO_RANGE = vec2(3.4e38, -3.4e38);

// A range, made to hold another. Written as comparisons, because those are false for a
// number that is none: GLSL's min and max may return it or not, as the driver likes.
vec2 widened(vec2 range, vec2 other) {
    return vec2(other.x < range.x ? other.x : range.x, other.y > range.y ? other.y : range.y);
}

// What roundings alone make of equal numbers, over their size: sixteen steps of a float, as many
// as 32 additions may make.
const float ROUNDINGS = 16.0 * 1.1920929e-7;

// How far apart the lowest and the highest are; 0 if they are one number but for its roundings: to
// stretch these to 0..1 would make mountains of them. Below 1e-37, 1 over it would be no float.
float span_of(vec2 range) {
    float span = range.y - range.x;
    return span > max(1e-37, ROUNDINGS * max(abs(range.x), abs(range.y))) ? span : 0.0;
}
#endif
