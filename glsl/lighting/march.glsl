// lighting/march.glsl -- a ray march over the terrain towards a light, for any method of shadows.
//
//   gives    March, march_from, steps_below, marched, INTERPOLATED, CUT_DOWN
//   asks     of the kernel that includes it: after_step, is_decided
//   needs    terrain/blocks.glsl, terrain/heightfield.glsl; heights and their block maxima come as
//            arguments
//   units    places in texels; heights and lengths in metres; steps along the axis that the ray
//            follows more
//   source   Belaiche 2010, section 3.5.4; the leaps over low blocks derived here
//   tested   tests/glsl/test_shadows.py, against a march in NumPy; tests/glsl/test_lighting.py
//
// A ray starts at a place's own height and climbs towards the light in equal steps. A method
// keeps one number about it: 1 or 0 for a hidden sun, the free part of a cone, a horizon. At each
// step it is given the height of the terrain and says what that makes of its number:
//
//     for t = 1, 2, … count:   found = after_step(found, march, t, terrain height at step t)
//
// until is_decided(found), when no further step can change the number.
#ifndef LIGHTING_MARCH
#define LIGHTING_MARCH
#include "terrain/blocks.glsl"
#include "terrain/heightfield.glsl"

struct March {
    vec2 start;    // texels
    vec2 ahead;    // texels a step
    ivec2 across;  // one texel along the axis that the ray follows less
    bool on_lines; // whether every place is on a line of texels
    float relief;  // metres from height 0 to height 1
    float foot;    // the height where it begins   [m]
    float climb;   // of the ray, a step           [m]
    float path;    // length of a step on the ray  [m]
    float run;     // and on level ground          [m]
    int count;     // steps that stay on the terrain
};

// What a method says: its number after step t, over terrain of a height in metres.
float after_step(float found, March march, float t, float terrain);
bool is_decided(float found);

// The computation

// How heights between texels are sampled.
const int INTERPOLATED = 0;
const int CUT_DOWN = 1;  // the thesis's: of the texel that a place is cut down to

// Steps until a place leaves 0..last along one axis.
float steps_inside(float place, float ahead, float last) {
    if (ahead == 0.0) return 1e9;
    return (ahead > 0.0 ? last - place : place) / abs(ahead);
}

// Whole steps, of so many: one that ends on the edge counts, despite rounding. The limit is
// over four times the texels that a texture may have a side, and far below the largest int.
const float MOST_STEPS = 1e6;
int whole_steps(float steps) {
    return int(clamp(steps + 1e-3, 0.0, MOST_STEPS));
}

// A march over heights from a place on them towards a light, which is a unit vector. A step is so
// many texels long, along the axis that the ray follows more.
March march_from(sampler2D field, vec2 place, bool on_texel, vec3 light, vec2 extent_in_metres,
                 float metres_of_relief, float step_length) {
    ivec2 grid = textureSize(field, 0);
    vec2 way = light.xy / spacing_of(grid, extent_in_metres);
    // A ray straight up leaves its texel nowhere: it takes no step, and its numbers stay finite.
    float longer = max(max(abs(way.x), abs(way.y)), 1e-12);
    bool along_x = abs(way.x) >= abs(way.y);
    March march;
    march.start = place;
    // Whole texels along the longer axis must stay whole, which division does not promise.
    march.ahead = step_length * vec2(along_x ? sign(way.x) : way.x / longer,
                                     along_x ? way.y / longer : sign(way.y));
    march.across = along_x ? ivec2(0, 1) : ivec2(1, 0);
    // From a texel in whole steps, every place is on a line of texels.
    march.on_lines = on_texel && floor(step_length) == step_length;
    march.relief = metres_of_relief;
    march.foot = height_at(field, place) * metres_of_relief;
    march.climb = step_length * light.z / longer;
    march.path = step_length / longer;
    march.run = march.path * length(light.xy);
    vec2 last = vec2(grid - 1);
    march.count = whole_steps(min(steps_inside(place.x, march.ahead.x, last.x),
                                  steps_inside(place.y, march.ahead.y, last.y)));
    if (length(light.xy) < 1e-6) march.count = 0;
    return march;
}

float height_at_step(sampler2D field, March march, int t, int sampling, bool on_lines) {
    vec2 place = march.start + float(t) * march.ahead;
    if (sampling == CUT_DOWN) {
        ivec2 last = textureSize(field, 0) - 1;
        return texelFetch(field, ivec2(clamp(place, vec2(0.0), vec2(last))), 0).r;
    }
    return on_lines ? height_on_line(field, place, march.across) : height_at(field, place);
}

// What is only speed

// Blocks of 16 texels know their highest height (lighting/block_maxima). One that lies wholly
// below all that a method asks about is left in one leap. Heights in it are interpolated from
// its own texels and those just after, which its maximum includes: the leap passes over nothing.

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
        to = now + max(int(min(min(room.x, room.y), MOST_STEPS) - 1e-3), 0) + 1;
        float line = march.foot + min(float(now) * climb, float(to - 1) * climb);
        float highest = texelFetch(block_maxima, block, 0).r * march.relief;
        // What rounding may add to a height between texels, or take from the line.
        low = highest < line - 1e-5 * (abs(highest) + abs(march.foot) + abs(line));
        now = low ? to : now;
    } while (low && now <= count);
    to = min(to, count + 1);
    return now;
}

float marched_on(bool on_lines, int count, March march, sampler2D field, sampler2D block_maxima,
                 int sampling, float lowest_climb, float found) {
    int t = 1;
    while (t <= count) {
        int to;
        t = next_high_block(block_maxima, march, t, count, lowest_climb, to);
        // anchor: march
        for (; t < to; t++) {
            float terrain = height_at_step(field, march, t, sampling, on_lines) * march.relief;
            found = after_step(found, march, float(t), terrain);
            if (is_decided(found)) return found;
        }
        // end: march
    }
    return found;
}

// The method's number after all steps, from what it is before the first. Terrain below a line from
// the foot that climbs `lowest_climb` a step changes nothing.
float marched(March march, sampler2D field, sampler2D block_maxima, int sampling,
              float lowest_climb, float found) {
    // Two loops, of which one has no steps: software renderers take both ways of an if inside one.
    int on_lines = march.on_lines ? march.count : 0;
    int between = march.on_lines ? 0 : march.count;
    return march.on_lines
        ? marched_on(true, on_lines, march, field, block_maxima, sampling, lowest_climb, found)
        : marched_on(false, between, march, field, block_maxima, sampling, lowest_climb, found);
}
#endif
