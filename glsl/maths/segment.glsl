// maths/segment.glsl -- how far a place is from a piece of a straight line.
//
//   gives    distance_to_segment
//   needs    nothing: pure functions, no uniforms, no textures
//   units    any one unit of length
//   source   derived here
//   tested   tests/glsl/test_maths.py, against the nearest of many of its points
#ifndef MATHS_SEGMENT
#define MATHS_SEGMENT
float distance_to_segment(vec2 place, vec2 from, vec2 to) {
    vec2 along = to - from;
    float share = clamp(dot(place - from, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
    return length(place - from - share * along);
}
#endif
