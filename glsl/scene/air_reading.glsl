// scene/air_reading.glsl -- reading the air in front of what is seen, from its slices of distance.
//
//   gives    AIR_REACH, AIR_SLICES, slice_end, Aerial, aerial
//   needs    two textures by scene/air, read "linear"
//   units    metres; light as of lighting/daylight; what is left 0..1 a channel
//   source   Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering
//            Technique", section 5.4; slices that grow with the distance: Wronski 2014,
//            "Volumetric Fog: Unified, Compute Shader Based Solution to Atmospheric Scattering"
//            (SIGGRAPH course), here by the fourth power of their number: two roots to read
//   tested   tests/glsl/test_scene_air.py, against integrals in float64
//
// What is shown of a colour is colour * left + scattered.
//
// Sixteen pictures, four by four in one texture, are each the air up to one distance. Between two,
// the air itself is taken as even. Mist is not, where one looks down into it: its depth follows
// the cubic that has the depths and the densities of both ends (Hermite's), which the alphas
// hold. What is added grows as what is left falls.
#ifndef SCENE_AIR_READING
#define SCENE_AIR_READING

const float AIR_REACH = 100000.0;
const int AIR_SLICES = 16;

// Where a slice ends; slice -1 at the eye.
float slice_end(int slice) {
    float share = float(slice + 1) / float(AIR_SLICES);
    return AIR_REACH * share * share * share * share;
}

struct Aerial {
    vec3 scattered;
    vec3 left;
};

vec4 slice_at(sampler2D slices, vec2 share, int slice) {
    vec2 whole = vec2(textureSize(slices, 0));
    vec2 one = floor(whole / 4.0);
    vec2 inside = clamp(share * one, vec2(0.5), one - 0.5);
    return textureLod(slices, (inside + one * vec2(slice & 3, slice >> 2)) / whole, 0.0);
}

// `share` is the place in the picture, 0..1; `distance_of` that of what is seen from the eye.
Aerial aerial(sampler2D scattered, sampler2D left, vec2 share, float distance_of) {
    float at = sqrt(sqrt(max(distance_of, 0.0) / AIR_REACH)) * float(AIR_SLICES);
    int high = clamp(int(at), 0, AIR_SLICES - 1);
    float start = slice_end(high - 1);
    float part = clamp((distance_of - start) / (slice_end(high) - start), 0.0, 1.0);
    float step_of = 0.001 * (slice_end(high) - start);
    vec4 added = slice_at(scattered, share, high);
    vec4 last = max(slice_at(left, share, high), 1e-6);
    vec4 before = vec4(0.0);
    vec4 first = vec4(vec3(1.0), last.a);
    if (high > 0) {
        before = slice_at(scattered, share, high - 1);
        first = max(slice_at(left, share, high - 1), vec4(last.rgb, 0.0));
    }
    float uneven = part * (1.0 - part) * mix(
            (added.a - before.a) - last.a * step_of, first.a * step_of - (added.a - before.a),
            1.0 - part);
    vec3 lost = log(first.rgb / last.rgb);
    vec3 passed = first.rgb * exp(-clamp(lost * part + uneven, vec3(0.0), lost));
    vec3 gone = max(first.rgb - last.rgb, 1e-6);
    vec3 grown = mix(vec3(part), (first.rgb - passed) / gone, vec3(greaterThan(gone, vec3(1e-3))));
    return Aerial(mix(before.rgb, added.rgb, grown), passed);
}
#endif
