// lighting/walk.glsl -- the walk from a place towards a light: where its steps lead, and which of them land may meet.
//
//   gives    Walk, walk_from, steps_below, height_at_step, INTERPOLATED, CUT_DOWN, next_near, TOP_SHIFT
//   needs    terrain/heightfield.glsl; textures of heights and of their tops come as arguments
//   units    places in texels; heights and lengths in metres; steps along the axis that the walk follows more
//   source   Belaiche 2010, section 3.5.4; the leaps over low land derived here
//   tested   tests/glsl/test_shadows.py, against a march in NumPy; tests/glsl/test_lighting.py
//
// The walk begins at a place's own height and takes equal steps. What a method asks at each step
// is its own: whether land stands over the ray, or over the lower side of a cone around it.
//
// Blocks of 16 texels know their highest height (lighting/ray_cast/tops). A block that lies wholly
// below what is asked about is left in one leap. All heights in it are interpolated from its own
// texels and those just after, which its top includes, so the leap passes over nothing.
#ifndef LIGHTING_WALK
#define LIGHTING_WALK
#include "terrain/heightfield.glsl"

// How heights between texels are read.
const int INTERPOLATED = 0;
const int CUT_DOWN = 1;  // the thesis's: of the texel that a place is cut down to

const int TOP_SHIFT = 4;  // a block has 16 texels a side

struct Walk {
    vec2 start;    // texels
    vec2 ahead;    // texels a step
    ivec2 across;  // one texel along the axis that the walk follows less
    bool on_lines; // whether every place stands on a line of texels
    float foot;    // the height it begins at
    float climb;   // metres a step
    float path;    // metres of way a step, along the ray
    int count;     // steps that stay on the land
};

// Steps until a place leaves 0..last along one axis.
float steps_inside(float place, float ahead, float last) {
    if (ahead == 0.0) return 1e9;
    return (ahead > 0.0 ? last - place : place) / abs(ahead);
}

// Whole steps, of so many: one that ends on the edge counts, whatever the rounding.
int whole_steps(float steps) {
    return int(clamp(steps + 1e-3, 0.0, 65000.0));
}

// A walk from a place towards a light, which is a unit vector, over a grid of so many metres a texel.
Walk walk_from(vec2 start, float foot, vec3 light, ivec2 grid, vec2 metres, float stride, bool on_texel) {
    vec2 way = light.xy / metres;
    // A ray straight up leaves its texel nowhere: it takes no step, and its numbers stay finite.
    float longer = max(max(abs(way.x), abs(way.y)), 1e-12);
    bool along_x = abs(way.x) >= abs(way.y);
    Walk walk;
    walk.start = start;
    // Whole texels along the longer axis must stay whole, which division does not promise on every GPU.
    walk.ahead = stride * vec2(along_x ? sign(way.x) : way.x / longer, along_x ? way.y / longer : sign(way.y));
    walk.across = along_x ? ivec2(0, 1) : ivec2(1, 0);
    // From a texel in whole steps, every place is on a line of texels.
    walk.on_lines = on_texel && floor(stride) == stride;
    walk.foot = foot;
    walk.climb = stride * light.z / longer;
    walk.path = stride / longer;
    vec2 last = vec2(grid - 1);
    walk.count = whole_steps(min(steps_inside(start.x, walk.ahead.x, last.x), steps_inside(start.y, walk.ahead.y, last.y)));
    if (length(light.xy) < 1e-6) walk.count = 0;
    return walk;
}

// Steps, of those that a walk takes, until what begins at its foot and climbs so much a step is over a height.
int steps_below(Walk walk, float climb, float highest) {
    return climb > 0.0 ? min(walk.count, whole_steps((highest - walk.foot) / climb)) : walk.count;
}

// The height at a step. What `on_lines` and `reading` are should be known when the text is compiled.
float height_at_step(sampler2D field, Walk walk, int step_number, int reading, bool on_lines) {
    vec2 place = walk.start + float(step_number) * walk.ahead;
    if (reading == CUT_DOWN) {
        return texelFetch(field, ivec2(clamp(place, vec2(0.0), vec2(textureSize(field, 0) - 1))), 0).r;
    }
    return on_lines ? height_on_line(field, place, walk.across) : height_at(field, place);
}

// The first step from `from` on, of `count`, in a block that reaches up to a line: it begins `under` below
// the foot and climbs so much a step. `to` is the step after the last in that block.
int next_near(sampler2D tops, Walk walk, int from, int count, float under, float climb, float metres, out int to) {
    vec2 last = vec2(textureSize(tops, 0) << TOP_SHIFT) - 1.0;
    vec2 reach = 1.0 / max(abs(walk.ahead), vec2(1e-9));
    float foot = walk.foot - under;
    int now = from;
    bool low = true;
    do {
        vec2 place = clamp(walk.start + float(now) * walk.ahead, vec2(0.0), last);
        ivec2 block = ivec2(place) >> TOP_SHIFT;
        vec2 passed = place - vec2(block << TOP_SHIFT);
        vec2 room = mix(passed, float(1 << TOP_SHIFT) - passed, greaterThanEqual(walk.ahead, vec2(0.0))) * reach;
        // A little less than the room: a step just over the block's end asks the next block.
        to = now + max(int(min(min(room.x, room.y), 65000.0) - 1e-3), 0) + 1;
        float line = foot + min(float(now) * climb, float(to - 1) * climb);
        float top = texelFetch(tops, block, 0).r * metres;
        // What rounding may add to a height between texels, or take from the line.
        low = top < line - 1e-5 * (abs(top) + abs(foot) + abs(line));
        now = low ? to : now;
    } while (low && now <= count);
    to = min(to, count + 1);
    return now;
}
#endif
