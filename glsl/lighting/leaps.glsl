// lighting/leaps.glsl -- a ray march that leaps over blocks of low terrain.
//
//   gives    steps_below, leaping_march, leaping_march_from_texel
//   asks     of the kernel that includes it: after_step, is_decided
//   needs    lighting/march.glsl, terrain/blocks.glsl; heights and their block maxima come as
//            arguments
//   units    as lighting/march.glsl
//   source   derived here
//   tested   tests/glsl/test_shadows.py, against a march that never leaps
//
// Only for speed. A method keeps one number about a ray: 1 or 0 for a hidden sun, the free part of
// a cone, a horizon. At each step it is given the height of the terrain and says what that makes
// of its number, until no further step can change it (is_decided).
//
// Blocks of 16 texels know their highest height (lighting/block_maxima). One that lies wholly
// below all that a method asks about is left in one leap. Heights in it are interpolated from
// its own texels and those just after, which its maximum includes: the leap passes over nothing.
#ifndef LIGHTING_LEAPS
#define LIGHTING_LEAPS
#include "lighting/march.glsl"
#include "terrain/blocks.glsl"

// What a method says: its number after step t, over terrain of a height in metres.
float after_step(float found, March march, float t, float terrain);
bool is_decided(float found);

// Steps, of those of a march, until a line from its foot that climbs so much a step is over a
// height.
int steps_below(March march, float climb, float highest) {
    if (climb <= 0.0) return march.count;
    return min(march.count, whole_steps((highest - march.foot) / climb));
}

// The first step from `from` on, of `count`, in a block that reaches up to a line from the foot
// that climbs so much a step. `to` is the step after the last in that block.
int next_high_block(sampler2D block_maxima, March march, int from, int count,
                    float climb, out int to) {
    vec2 last = vec2(textureSize(block_maxima, 0) << BLOCK_SHIFT) - 1.0;
    vec2 steps_a_texel = 1.0 / max(abs(march.ahead), vec2(1e-9));
    bvec2 forwards = greaterThanEqual(march.ahead, vec2(0.0));
    int now = from;
    bool low = true;
    do {
        vec2 place = clamp(march.start + float(now) * march.ahead, vec2(0.0), last);
        ivec2 block = ivec2(place) >> BLOCK_SHIFT;
        vec2 passed = place - vec2(block << BLOCK_SHIFT);
        vec2 room = mix(passed, float(1 << BLOCK_SHIFT) - passed, forwards) * steps_a_texel;
        // A little less than the room: a step just over the block's end asks the next block.
        to = now + max(int(min(min(room.x, room.y), MAX_STEPS) - 1e-3), 0) + 1;
        float line = march.foot + min(float(now) * climb, float(to - 1) * climb);
        float highest = texelFetch(block_maxima, block, 0).r * march.relief;
        // What rounding may add to a height between texels, or take from the line.
        low = highest < line - 1e-5 * (abs(highest) + abs(march.foot) + abs(line));
        now = low ? to : now;
    } while (low && now <= count);
    to = min(to, count + 1);
    return now;
}

// The same height as terrain_at, in half the fetches where every step is on a line of texels.
float terrain_on_line(sampler2D field, March march, int i, int sampling, bool on_lines) {
    vec2 place = march.start + float(i) * march.ahead;
    ivec2 across = abs(march.ahead.x) >= abs(march.ahead.y) ? ivec2(0, 1) : ivec2(1, 0);
    float height = sampling == CUT_DOWN || !on_lines
        ? sampled_height(field, place, sampling)
        : height_on_line(field, place, across);
    return height * march.relief;
}

float marched_on(bool on_lines, int count, March march, sampler2D field, sampler2D block_maxima,
                 int sampling, float lowest_climb, float found) {
    int t = 1;
    while (t <= count) {
        int to;
        t = next_high_block(block_maxima, march, t, count, lowest_climb, to);
        // anchor: march
        for (; t < to; t++) {
            float terrain = terrain_on_line(field, march, t, sampling, on_lines);
            found = after_step(found, march, float(t), terrain);
            if (is_decided(found)) return found;
        }
        // end: march
    }
    return found;
}

// The method's number after all steps, from what it is before the first. Terrain below a line from
// the foot that climbs `lowest_climb` a step changes nothing.
float leaping_march(March march, sampler2D field, sampler2D block_maxima, int sampling,
                    float lowest_climb, float found) {
    return marched_on(false, march.count, march, field, block_maxima, sampling, lowest_climb,
                      found);
}

// The same from a texel in whole steps: then every place is on a line of texels. Two loops, of
// which one has no steps: software renderers take both ways of an if inside one.
float leaping_march_from_texel(bool on_texel, March march, sampler2D field,
                               sampler2D block_maxima, int sampling, float lowest_climb,
                               float found) {
    vec2 step_of = abs(march.ahead);
    float longer = max(step_of.x, step_of.y);
    bool on_lines = on_texel && floor(longer) == longer;
    int on = on_lines ? march.count : 0;
    int between = on_lines ? 0 : march.count;
    return on_lines
        ? marched_on(true, on, march, field, block_maxima, sampling, lowest_climb, found)
        : marched_on(false, between, march, field, block_maxima, sampling, lowest_climb, found);
}
#endif
