// lessons/edge.glsl -- whether a place is off a texture of heights.
//
//   gives    is_outside
//   needs    nothing: the texture comes as an argument
//   units    places in texels
//   source   none: a comparison
//   tested   tests/glsl/test_lesson_shadows.py: shadows end where they do in float64
//
// A ray that should end on the last texel may miss it by a rounding of its last bits.
#ifndef LESSONS_EDGE
#define LESSONS_EDGE
bool is_outside(sampler2D field, vec2 place) {
    vec2 last = vec2(textureSize(field, 0) - 1);
    return any(lessThan(place, vec2(-1e-3))) || any(greaterThan(place, last + 1e-3));
}
#endif
