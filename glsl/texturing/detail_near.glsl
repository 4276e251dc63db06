// texturing/detail_near.glsl -- a cover made finer by a detail image near the eye.
//
//   gives    detail_nearness, with_detail
//   needs    nothing: pure functions, no uniforms, no textures
//   units    distances in metres; colours linear; strength from 0, 1 for the image's own contrast
//   source   Belaiche 2010, section 2.7; the ratio to the mean in place of a blend: made here
//   tested   tests/glsl/test_texturing_detail.py, against the same sum in float64
//
// The thesis multiplies and has no transparency. A product with an image darker than white
// would darken the terrain near the eye; with the image over its own mean it does not, whatever
// the image.
#ifndef TEXTURING_DETAIL_NEAR
#define TEXTURING_DETAIL_NEAR

// 1 at the eye, 0 from `max_distance` on, with no slope at either end.
float detail_nearness(float eye_distance, float max_distance) {
    float share = clamp(1.0 - eye_distance / max(max_distance, 1e-6), 0.0, 1.0);
    return share * share * (3.0 - 2.0 * share);
}

// The cover times so much of the detail's ratio to its mean. A strength above 1 could go below
// black.
// anchor: detail
vec3 with_detail(vec3 cover, vec3 detail, vec3 mean, float strength) {
    return cover * max(mix(vec3(1.0), detail / max(mean, vec3(1e-4)), strength), 0.0);
}
// end: detail
#endif
