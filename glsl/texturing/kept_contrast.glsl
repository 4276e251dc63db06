// texturing/kept_contrast.glsl -- three images mixed without loss of contrast.
//
//   gives    mixed_with_contrast
//   needs    nothing: pure functions, no uniforms, no textures
//   units    weights sum to 1; colours linear, each image with the same mean
//   source   Heitz and Neyret 2018, "High-Performance By-Example Noise using a
//            Histogram-Preserving Blending Operator" (Proc. ACM CGIT 1(2)), the blend that
//            keeps the variance; without their change to Gaussian histograms and back
//   tested   tests/glsl/test_texturing_hex.py, against the statistics of random numbers
//
// The variance of a sum of images that share nothing is the sum of w² times theirs. So where
// all weights are a third, a plain mean has 0.58 of the contrast, and the eye sees the border.
#ifndef TEXTURING_KEPT_CONTRAST
#define TEXTURING_KEPT_CONTRAST

vec3 mixed_with_contrast(vec3 weights, vec3 first, vec3 second, vec3 third, vec3 mean) {
    vec3 deviation = weights.x * (first - mean) + weights.y * (second - mean)
            + weights.z * (third - mean);
    return max(mean + deviation / length(weights), vec3(0.0));
}
#endif
