// scene/water/ripples.glsl -- the waves in a pixel: of the wind and its gusts, or of a current.
//
//   gives    Ripples, gust_at, ripples_of_wind, ripples_of_current
//   needs    noise/gradient.glsl, scene/footprint.glsl, water/waves.glsl; the table of
//            scene/water/moment comes as an argument
//   units    metres, seconds, metres a second; slopes in metres over metres
//   source   two layers that take turns: Vlachos 2010, "Water Flow in Portal 2" (SIGGRAPH course)
//   tested   tests/glsl/test_scene_water.py
#ifndef SCENE_WATER_RIPPLES
#define SCENE_WATER_RIPPLES
#include "noise/gradient.glsl"
#include "scene/footprint.glsl"
#include "water/waves.glsl"

struct Ripples {
    Waves waves;
    float lowest;  // how steeply the lowest mirrored rays rise that meet no other wave
    float lump;    // of foam  [m]
};

const float HIDDEN = 0.35;  // of the slopes' deviation: flatter rays meet another wave
const float REPEATS = 3.0;  // [s] after which what a current carries begins again

// The wind over its mean, in patches and in groups of waves. `wind` is its velocity.
float gust_at(vec2 place, vec2 wind, float uneven, float seconds, float longest, float pixel,
              uint seed) {
    vec2 run = seconds * wind;
    float wide = clamp(170.0 / max(pixel, 1.0) - 1.0, 0.0, 1.0);
    float gust = wide * perlin((place - run) / 370.0, seed).x
            + wide * 0.7 * perlin((place - 0.8 * run) / 90.0, seed + 1u).x;
    float group = 5.0 * longest;
    float near = clamp(0.5 * group / pixel - 1.0, 0.0, 1.0);
    if (near > 0.0) gust += near * 0.8 * perlin((place - 0.3 * run) / group, seed + 2u).x;
    return clamp(1.0 + 1.5 * uneven * gust, 0.05, 2.5);
}

Ripples ripples_of_wind(sampler2D moment, Sea sea, float gust, vec2 place, float seconds,
                        Footprint foot) {
    Waves even = waves_at(moment, 0, sea, place, seconds, foot);
    Waves waves = Waves(even.slope * sqrt(gust), even.variance * gust);
    return Ripples(waves, HIDDEN * sqrt(sea.variance * gust), clamp(0.1 * sea.longest, 0.6, 3.0));
}

// What a current carries begins again every few seconds, in two layers that take turns.
Ripples ripples_of_current(sampler2D moment, vec2 current, float white, vec2 place, float seconds,
                           Footprint foot) {
    Sea river = river_of(length(current), white);
    vec2 phase = fract(vec2(0.0, 0.5) + seconds / REPEATS);
    vec2 weight = 1.0 - abs(2.0 * phase - 1.0);
    weight /= length(weight);
    vec2 first = place - current * (phase.x * REPEATS);
    vec2 second = place - current * (phase.y * REPEATS) + 71.3;
    Waves one = waves_at(moment, 1, river, first, seconds, foot);
    Waves two = waves_at(moment, 1, river, second, seconds, foot);
    Waves waves = Waves(weight.x * one.slope + weight.y * two.slope, one.variance);
    return Ripples(waves, HIDDEN * sqrt(one.variance), 0.7);
}
#endif
