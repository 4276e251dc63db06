// scene/near/materials.glsl -- how rough grass, stones, rock and snow are at each size.
//
//   gives    roughness_of, contrast_of, snow_roughness
//   needs    nothing: pure functions, no uniforms, no textures
//   units    shares of grass, stones and rock in x, y and z; rms slopes in metres over metres of
//            one octave; contrasts as shares of the colour; rungs as in scene/near/ladder.glsl
//   source   made here, tuned on pictures: tussocks of 10 cm to 1 m, gravel of 2 to 20 cm;
//            rock is as rough at any size (Mandelbrot 1982, "The Fractal Geometry of Nature")
//   tested   tests/glsl/test_near.py, through the variance of the bumps
#ifndef SCENE_NEAR_MATERIALS
#define SCENE_NEAR_MATERIALS

// 1 at a rung, falling to 0 so many rungs away.
float around_rung(int rung, float middle, float wide) {
    return max(1.0 - abs(float(rung) - middle) / wide, 0.0);
}

float roughness_of(vec3 kinds, int rung) {
    return dot(kinds, vec3(0.05 + 0.13 * around_rung(rung, 8.0, 6.0),
                           0.045 + 0.17 * around_rung(rung, 10.0, 6.0), 0.17));
}

float contrast_of(vec3 kinds, int rung) {
    return dot(kinds, vec3(0.13 + 0.15 * around_rung(rung, 9.0, 7.0),
                           0.12 + 0.16 * around_rung(rung, 10.0, 7.0), 0.14));
}

// Wind packs snow into waves of a metre or so; what is finer melts together.
float snow_roughness(int rung) {
    return 0.015 + 0.05 * around_rung(rung, 6.0, 3.0);
}
#endif
