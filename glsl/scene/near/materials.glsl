// scene/near/materials.glsl -- how rough grass, stones, rock and snow are at each size.
//
//   gives    roughness_of, contrast_of, snow_roughness
//   needs    nothing: pure functions, no uniforms, no textures
//   units    shares of grass, stones and rock in x, y and z; rms slopes in metres over metres of
//            one octave; contrasts as shares of the colour; rungs as in scene/near/ladder.glsl
//   source   made here, tuned on pictures: tussocks of 5 to 50 cm, gravel of 2 to 10 cm; rock is
//            as rough at any size (Mandelbrot 1982, "The Fractal Geometry of Nature")
//   tested   tests/glsl/test_near.py, through the variance of the bumps
#ifndef SCENE_NEAR_MATERIALS
#define SCENE_NEAR_MATERIALS

// 1 at a rung, falling to 0 so many rungs away.
float around_rung(int rung, float middle, float wide) {
    return max(1.0 - abs(float(rung) - middle) / wide, 0.0);
}

float roughness_of(vec3 kinds, int rung) {
    return dot(kinds, vec3(0.045 + 0.205 * around_rung(rung, 9.0, 4.0),
                           0.04 + 0.28 * around_rung(rung, 11.0, 4.0), 0.17));
}

float contrast_of(vec3 kinds, int rung) {
    return dot(kinds, vec3(0.10 + 0.20 * around_rung(rung, 10.0, 5.0),
                           0.08 + 0.22 * around_rung(rung, 11.0, 4.0), 0.13));
}

// Wind packs snow into waves of a metre or so; what is finer melts together.
float snow_roughness(int rung) {
    return 0.015 + 0.05 * around_rung(rung, 6.0, 3.0);
}
#endif
