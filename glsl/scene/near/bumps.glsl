// scene/near/bumps.glsl -- the ground's own bumps under a pixel: slopes, height, light and dark.
//
//   gives    Bumps, bumps_at
//   needs    noise/gradient.glsl, scene/near/ladder.glsl, scene/near/materials.glsl
//   units    metres; slopes in metres over metres; light and dark as shares of the colour
//   source   octaves of noise with their slopes: Perlin 1985, "An Image Synthesizer" (SIGGRAPH);
//            Blinn 1978, "Simulation of Wrinkled Surfaces" (SIGGRAPH)
//   tested   tests/glsl/test_near.py, against float64: slopes are the heights' derivatives, means
//            are 0, and the variance is that of the slopes in a round pixel
//
// Each octave is gradient noise on its own lattice in metres. What stands higher is lighter, as
// tips of grass are, and hollows are darker: both follow one noise.
//
// Where the eye is low and a pixel long, `variance` is too little: it takes the places of a mean
// over the pixel for unrelated. The slopes' own is 1.03 to 1.24 of it in a pixel of 0.32 m by
// 0.08 m, and up to 1.49 in one of 4 m by 1 m.
#ifndef SCENE_NEAR_BUMPS
#define SCENE_NEAR_BUMPS
#include "noise/gradient.glsl"
#include "scene/near/ladder.glsl"
#include "scene/near/materials.glsl"

struct Bumps {
    vec2 slope;        // of the bare ground's bumps, east and north
    vec2 snowy;        // of the same under snow: small ones are buried
    float height;      // of what is smaller than a step, over its mean  [m]
    float whole;       // its rms  [m]
    float hidden;      // and that of what of it is too small for the pixel  [m]
    float variance;    // of `slope` along an axis, its mean over places
    float snow_variance;
    float tone;        // lighter or darker, of mean 0
    float dry;         // tufts of straw and of fresh grass, of mean 0
};

const float PERLIN_SLOPE = 0.94501;  // root of the mean square of a slope along an axis
const float PERLIN_FOLDED = 0.26663; // mean of the noise without its sign
const float FOLDED_RMS = 0.18822;    // root of the mean square of what that is from its mean
const float A_STEP = 1.0;            // [m]
const int STEP_RUNG = 6;             // the rung of that
const float A_TUFT = 1.0;            // [m] cells of the widest tufts
// Each lattice is turned against the last: rows of one are seen where one looks along them.
const mat2 NEXT_TURN = mat2(0.8, 0.6, -0.6, 0.8);
const uint BUMPS_SALT = 0x411167ebu;  // CRC-32 of "scene/near/bumps"

// A noise and its slopes; small ones as tufts and pebbles have them: round, with sharp furrows
// between. Its mean is 0 in either case.
vec3 bumped(vec3 noise, bool round_topped) {
    if (!round_topped) return noise;
    return (noise.x < 0.0 ? -noise : noise) - vec3(PERLIN_FOLDED, 0.0, 0.0);
}

// The mean of one octave over a pixel that is `along` long: of four places there, of two, or one.
// `halves` are 0 where the octave needs no mean over halves and quarters of it.
vec3 octave_over(vec2 place, vec2 along, vec2 halves, bool round_topped, uint seed) {
    int count = halves.y > 0.0 ? 4 : halves.x > 0.0 ? 2 : 1;
    vec2 apart = halves * vec2(0.25, 0.125);
    vec3 sum = vec3(0.0);
    for (int j = 0; j < count; j++) {
        vec2 side = vec2(ivec2(j, j >> 1) & 1) * 2.0 - 1.0;
        sum += bumped(perlin(place + dot(side, apart) * along, seed), round_topped);
    }
    return sum / float(count);
}

// `kinds` are shares of grass, stones and rock, `pixel` what a pixel covers there, `spacing`
// that of the heightmap, `depth` how deep snow is; all in metres. `grain` draws places together
// along which bumps are long, as ripples of sand are.
Bumps bumps_at(vec2 place, mat2 grain, vec3 kinds, float strength, PixelOnGround pixel,
               float spacing, float depth) {
    Bumps b = Bumps(vec2(0.0), vec2(0.0), 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    int end = last_rung(pixel.finest);
    mat2 turn = grain;
    for (int k = first_rung(spacing); k < end; k++) {
        turn = NEXT_TURN * turn;
        float cell = cell_of(k);
        float part = shown_to(cell, pixel.finest) * beyond_map(cell, spacing);
        vec2 halves = 1.0 - vec2(shown_to(cell, pixel.wide), shown_to(cell, 0.5 * pixel.wide));
        bool round_topped = cell <= A_TUFT;
        // No lattice point is one of the next lattice's, where both would be flat.
        vec3 noise = octave_over(turn * place / cell + vec2(0.618034, 0.381966) * float(k),
                                 turn * pixel.along / cell, halves, round_topped,
                                 lattice_seed(BUMPS_SALT, k));
        noise.yz = noise.yz * turn;
        float rough = strength * roughness_of(kinds, k);
        float slope = part * rough / PERLIN_SLOPE;
        float buried = cell / (cell + 6.0 * depth);
        float snow = part * strength * mix(snow_roughness(k), roughness_of(kinds, k), buried);
        b.slope += slope * noise.yz;
        b.snowy += snow / PERLIN_SLOPE * noise.yz;
        // Means over two places have half the variance; along a grain there is less.
        float mean_of = 0.5 * (dot(grain[0], grain[0]) + dot(grain[1], grain[1]))
                / ((1.0 + halves.x) * (1.0 + halves.y));
        b.variance += mean_of * part * part * rough * rough;
        b.snow_variance += mean_of * snow * snow;
        if (cell <= A_STEP) b.height += slope * cell * noise.x;
        float contrast = part * strength * contrast_of(kinds, k);
        b.tone += (round_topped ? 1.8 : 1.0) * contrast * noise.x;
        b.dry += contrast * noise.y;
    }
    // The first rung of them, and what is below it: a fifth more.
    float tall = 1.2 * strength * FOLDED_RMS / PERLIN_SLOPE;
    b.whole = tall * roughness_of(kinds, STEP_RUNG) * A_STEP;
    float left = min(2.0 * pixel.finest, A_STEP);
    b.hidden = min(tall * roughness_of(kinds, clamp(end, STEP_RUNG, RUNGS - 1)) * left, b.whole);
    return b;
}
#endif
