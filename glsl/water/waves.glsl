// water/waves.glsl -- waves that the wind makes on deep water: slopes as seen, and the rest.
//
//   gives    WAVES, Sea, sea_of, river_of, wave_row, Waves, waves_at
//   needs    noise/gradient.glsl, noise/hash.glsl, scene/footprint.glsl; a table by
//            water/wave_table comes as an argument
//   units    metres, seconds, metres a second; slopes in metres over metres, east and north;
//            variance: mean of squared slopes, both axes together
//   source   variance by wind: Cox and Munk 1954, "Measurement of the Roughness of the Sea Surface
//            from Photographs of the Sun's Glitter", J. Opt. Soc. Am. 44(11): 0.003 + 0.00512 U;
//            the longest wave and its height by wind and fetch: Hasselmann and others 1973
//            (JONSWAP), no longer than those of a fully grown sea (Pierson and Moskowitz 1964);
//            waves narrower than pixels as variance: Olano and Baker 2010, "LEAN Mapping" (I3D)
//   tested   tests/glsl/test_water_surface.py: slopes as finite differences of a sum of waves in
//            float64; variance and drawn slopes together are the same at any distance
//
// A sum of WAVES sines, from the longest down to SHORTEST, each pair of the same share of the
// variance: in the equilibrium range slopes have as much of it in every octave. Of a pair one is
// the stronger, and turns slowly from pair to pair: so at every size there is a main direction.
// Each moves by the dispersion of deep water, w^2 = g k. Seen with fewer than SHARP pixels to a
// wave it fades, and with BLURRED it is gone; what it loses of its mean square goes to `variance`:
//
//     sum of (shown_i s_i)^2 / 2 + variance = 0.003 + 0.00512 U      wherever one stands.
//
// By a wave's own direction: along the line of sight it fades sooner than across. Places are bent
// by a slow noise first: crests are short and curved, and no pattern of few sines shows.
#ifndef WATER_WAVES
#define WATER_WAVES
#include "noise/gradient.glsl"
#include "noise/hash.glsl"
#include "scene/footprint.glsl"

const int WAVES = 26;
const float SHORTEST = 0.22;    // [m] drawn; ripples shorter than that are variance at once
const float CAPILLARY = 0.01;   // [m] where the octaves of equal variance end
// Pixels to a wave. What is mirrored is no linear function of a slope: of a wave that is sampled
// no finer than sines need, that would still show rings where pixels and waves beat.
const float SHARP = 7.0;
const float BLURRED = 3.0;
const float BENT = 0.9;         // longest waves that noise moves a place by, at most
const float BENDS = 5.0;        // and those to a lump of that noise
const float GRAVITY = 9.81;
const float TURN = 6.2831853;
const uint WAVES_SALT = 0x7360d40au;  // CRC-32 of "water/waves"

struct Sea {
    vec2 towards;    // where the wind blows, a unit vector
    float longest;   // wave                                   [m]
    float high;      // significant height of its waves        [m]
    float variance;  // of all slopes
    float drawn;     // of those that the sines have
};

Sea sea_of(float wind, float fetch, vec2 towards) {
    float speed = max(wind, 0.05);
    // Both by the dimensionless fetch; a sea that is fully grown grows no more.
    float grown = GRAVITY * fetch / (speed * speed);
    float peak = max(22.0 * pow(grown, -1.0 / 3.0), 0.88) * GRAVITY / speed;
    float high = min(0.0016 * sqrt(grown), 0.21) * speed * speed / GRAVITY;
    float longest = max(TURN * GRAVITY / (peak * peak), 2.0 * SHORTEST);
    float variance = wind > 0.0 ? 0.003 * min(wind, 1.0) + 0.00512 * wind : 0.0;
    float octaves = log(longest / SHORTEST) / log(longest / CAPILLARY);
    return Sea(towards, longest, high, variance, octaves * variance);
}

// Running water, by its speed and how white it is: short waves that go all ways.
Sea river_of(float speed, float white) {
    float variance = 0.004 + 0.006 * speed * speed + 0.04 * white;
    return Sea(vec2(0.0), 1.6, 0.0, variance, 0.75 * variance);
}

// One row of the table: waves a metre east and north [1/m], where it is in its turn now, and its
// length [m]. Around the wind, or all ways where it has no direction.
vec4 wave_row(Sea sea, int k, float seconds) {
    vec2 mixed = random_pair(ivec2(k, 0), WAVES_SALT);
    float longer = sea.longest * pow(SHORTEST / sea.longest, float(k) / float(WAVES - 1))
            * (0.9 + 0.2 * mixed.x);
    // Directions by the golden ratio: even over any run of waves; long ones keep to the wind.
    float deviation = 2.0 * fract(float(k) * 0.6180340 + 0.25) - 1.0;
    float angle = deviation * (0.55 + 0.45 * abs(deviation))
            * mix(0.9, 1.7, float(k) / float(WAVES));
    bool blown = dot(sea.towards, sea.towards) > 0.0;
    if (!blown) angle = 0.5 * TURN * deviation;
    vec2 along = blown ? sea.towards : vec2(1.0, 0.0);
    vec2 ahead = mat2(cos(angle), sin(angle), -sin(angle), cos(angle)) * along;
    float turns = fract(mixed.y - fract(sqrt(GRAVITY / (TURN * longer)) * seconds));
    return vec4(ahead / longer, turns, longer);
}

struct Waves {
    vec2 slope;      // of the waves that are seen as waves
    float variance;  // of those that are not
};

// A place that is bent by so much of the longest wave, over a few of them, and drifts with them.
vec2 bent(Sea sea, vec2 place, float seconds) {
    float run = 0.5 * sqrt(GRAVITY * sea.longest / TURN) * seconds;
    vec2 at = (place - run * sea.towards) / (BENDS * sea.longest);
    return place + sea.longest * BENT * vec2(perlin(at, WAVES_SALT).x,
                                             perlin(at + 0.5, WAVES_SALT + 1u).x);
}

// At a place, by a row of the table of its sea; `foot` is what a pixel covers there.
Waves waves_at(sampler2D table, int row, Sea sea, vec2 place, float seconds, Footprint foot) {
    float one = sea.drawn / float(WAVES);
    // The shorter side of the footprint decides when no shorter wave can be seen.
    float min_length = BLURRED * sqrt(min(dot(foot.right, foot.right), dot(foot.up, foot.up)));
    Waves found = Waves(vec2(0.0), sea.variance - sea.drawn);
    vec2 there = bent(sea, place, seconds);
    int k = 0;
    while (k < WAVES) {
        vec4 wave = texelFetch(table, ivec2(k, row), 0);
        // Rows are as long as each other by a fifth or so: the next may still be longer.
        if (wave.w < 0.8 * min_length) break;
        float part = one * ((k & 1) == 0 ? 1.5 : 0.5);
        // anchor: shown
        float passed = max(abs(dot(wave.xy, foot.right)), abs(dot(wave.xy, foot.up)));
        float shown = clamp((1.0 / max(passed, 1e-6) - BLURRED) / (SHARP - BLURRED), 0.0, 1.0);
        // In turns, whose whole part is dropped: kilometres from the corner floats stay exact.
        float turns = fract(dot(wave.xy, there)) + wave.z;
        found.slope += wave.xy * (wave.w * shown * sqrt(2.0 * part) * cos(TURN * turns));
        found.variance += part * (1.0 - shown * shown);
        // end: shown
        k++;
    }
    found.variance += one * (float(WAVES - k) - 0.5 * float(k & 1));
    return found;
}
#endif
