// maths/square.glsl -- where a line on level ground is over a rectangle.
//
//   gives    span_through
//   needs    nothing: pure functions, no uniforms, no textures
//   units    the same for places and sides; the way in lengths of `ahead`
//   source   the slab method: Kay and Kajiya 1986, "Ray Tracing Complex Scenes"
//   tested   tests/glsl/test_maths.py, against the four sides in float64
#ifndef MATHS_SQUARE
#define MATHS_SQUARE

// How far it is from a place, along `ahead`, into the rectangle from 0 to `sides` and out of it,
// in that order; the first is not less than the second where the line never is over it.
vec2 span_through(vec2 place, vec2 ahead, vec2 sides) {
    vec2 safe = mix(ahead, vec2(1e-9), lessThan(abs(ahead), vec2(1e-9)));
    vec2 one = -place / safe;
    vec2 other = (sides - place) / safe;
    vec2 low = min(one, other);
    vec2 high = max(one, other);
    return vec2(max(low.x, low.y), min(high.x, high.y));
}
#endif
