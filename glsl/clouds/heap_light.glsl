// clouds/heap_light.glsl -- what comes to the eye of the sun's light in a heap of drops.
//
//   gives    sun_in_heap
//   needs    sky/drops.glsl
//   units    light times pi over that of the sun's beam on a surface that faces it; optical depths
//            as in sky/drops.glsl
//   source   octaves of a beam that fades ever more slowly and spreads ever more: Wrenninge, Kulla
//            and Lundqvist 2013, "Oz: The Great and Volumetric" (SIGGRAPH talks); their strengths
//            are tuned for photons followed through tiles of clouds/field, of three covers under
//            suns at 60 and 25 degrees, from below, from the side and from above
//   tested   tests/glsl/test_cloud_light.py, against photons followed one by one in float64
//
// A heap that stands alone loses light through all its sides: it fades along the sun's ray.
// Where clouds stand all around, light that leaves one enters the next: then they are a layer,
// into which light comes from above, and of which sky/drops.glsl has the solution.
//
// Over that of photons, in several runs of 12288 each, the light of a whole picture is
//
//     cover 0.35, sun at 25 degrees, behind the eye, from below      0.97, 0.89
//     cover 0.6, sun at 60 degrees, from above                       0.97, 0.94
//     cover 0.85, sun at 60 degrees, before the eye, from below      1.08, 0.94
//     cover 0.35, sun at 60 degrees, beside the eye, from below      1.25, 1.36, 1.33, 1.19, 1.00
//     cover 0.6, sun at 8 degrees, behind the eye, from below        0.77 to 0.95
//
// So the first three are within a fifth in each run. Beside the sun, under few clouds, it is a
// fifth too strong, 1.21 of the mean of five runs; under a low sun it is 0.84 of that of seven.
#ifndef CLOUDS_HEAP_LIGHT
#define CLOUDS_HEAP_LIGHT
#include "sky/drops.glsl"

// After a depth on the sun's ray, under a depth straight up, in a cloud of a whole depth; `around`
// is how thick clouds are there on the mean, `together` the cosine between the eye's ray and the
// sun, `upwards` that between the eye's ray and straight up.
float sun_in_heap(float depth, float above, float whole, float around, float sine,
                  float together, float upwards) {
    float once = 3.14159265 * drops_phase_wide(together) * exp(-depth);
    float forwards = 12.5663706 * henyey_greenstein(together, 0.5);
    float alone = 0.132 * forwards * exp(-0.5 * depth) + 0.275 * exp(-0.2 * depth);
    Diffuse layer = diffuse_of_beam(above, whole, max(sine, 0.02));
    float often = 3.14159265 * max(layer.mean + WIDE_G * layer.down * upwards, 0.0);
    return once + (1.0 - around * around) * alone + min(1.2 * around, 0.93) * often;
}
#endif
