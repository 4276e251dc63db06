// scene/near/snow.glsl -- how much of a pixel snow covers, by its depth and the bumps under it.
//
//   gives    SNOW_COLOUR, snow_share, add_snow
//   needs    scene/near/bumps.glsl, scene/surface.glsl
//   units    metres; share 0..1; colour linear
//   source   fresh snow reflects 0.8 to 0.9, old snow 0.5 to 0.7: Wiscombe and Warren 1980, "A
//            Model for the Spectral Albedo of Snow" (Journal of the Atmospheric Sciences 37)
//   tested   tests/glsl/test_near.py: none at depth 0, more where it is deeper, all where it is
//            deeper than every bump
#ifndef SCENE_NEAR_SNOW
#define SCENE_NEAR_SNOW
#include "scene/near/bumps.glsl"
#include "scene/surface.glsl"

const vec3 SNOW_COLOUR = vec3(0.80, 0.83, 0.87);

// `over` is the height of the bumps over their mean, `whole` its rms, `hidden` that of those too
// small to be seen; `patchy` from -1 to 1 where wind has left more or less, over tens of metres.
// A depth that covers half does so from near by and from afar.
float snow_share(float depth, float over, float whole, float hidden, float patchy) {
    float lies = depth * (1.0 + 0.6 * patchy);
    float half_covered = 0.03 + 2.0 * whole;
    float soft = 0.02 + 2.0 * hidden;
    // None where there is none, however deep the hollow.
    float some = smoothstep(0.0, 0.5 * half_covered, lies);
    return some * smoothstep(half_covered - soft, half_covered + soft, lies - over);
}

void add_snow(inout Surface surface, float depth, Bumps bumps, float patchy) {
    if (depth <= 0.0) return;
    float share = snow_share(depth, bumps.height, bumps.whole, bumps.hidden, patchy);
    surface.albedo = mix(surface.albedo, SNOW_COLOUR, share);
    surface.push = mix(surface.push, vec3(bumps.snowy, 0.0), share);
    surface.variance = mix(surface.variance, bumps.snow_variance, share);
    surface.film *= 1.0 - share;
}
#endif
