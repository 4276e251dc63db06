// texturing/planes.glsl -- which of three planes a slope takes its texture from.
//
//   gives    planes_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    slopes in degrees from the level; shares that sum to 1, of the planes that face east,
//            north and up
//   source   Geiss 2007, "Generating Complex Procedural Terrains Using the GPU" (GPU Gems 3,
//            chapter 1); only on cliffs: made here
//   tested   tests/glsl/test_near.py
#ifndef TEXTURING_PLANES
#define TEXTURING_PLANES

// Ground flatter than `cliffs.x` is seen from above alone, from `cliffs.y` on all that counts is
// the normal; `sharpness` narrows the borders.
vec3 planes_of(vec3 normal, vec2 cliffs, float sharpness) {
    vec3 weights = pow(max(abs(normal), vec3(1e-4)), vec3(sharpness));
    weights /= weights.x + weights.y + weights.z;
    float angle = degrees(acos(clamp(normal.z, 0.0, 1.0)));
    float steep = clamp((angle - cliffs.x) / max(cliffs.y - cliffs.x, 1e-3), 0.0, 1.0);
    return mix(vec3(0.0, 0.0, 1.0), weights, steep);
}
#endif
