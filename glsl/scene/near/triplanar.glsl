// scene/near/triplanar.glsl -- which of three planes a slope takes its texture from.
//
//   gives    planes_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    slopes in metres over metres; shares that sum to 1, of the planes that face east,
//            north and up
//   source   Geiss 2007, "Generating Complex Procedural Terrains Using the GPU" (GPU Gems 3,
//            chapter 1), as texturing/triplanar has it
//   tested   tests/glsl/test_near.py
#ifndef SCENE_NEAR_TRIPLANAR
#define SCENE_NEAR_TRIPLANAR

// Ground flatter than 30 degrees is seen from above alone, from 45 on all that counts is the
// normal; powers narrow the borders.
vec3 planes_of(vec3 normal) {
    vec3 square = normal * normal;
    vec3 shares = square * square;
    shares /= shares.x + shares.y + shares.z;
    float steep = smoothstep(0.5, 0.70710678, length(normal.xy));
    return mix(vec3(0.0, 0.0, 1.0), shares, steep);
}
#endif
