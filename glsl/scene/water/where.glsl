// scene/water/where.glsl -- which point of the water each pixel sees.
//
//   gives    seen_water: the point on the water and WATER as scene/surfaces.glsl has it;
//            elsewhere what the pixel sees without water; state: depth of the water over what
//            is seen through it, below 0 how far dry ground is above it; its current east and
//            north, and how white it runs
//   needs    maths/square.glsl, scene/surfaces.glsl, terrain/heightfield.glsl,
//            water/sheet_reading.glsl; seen, a height 0..1, water by water/sea or water/sheet
//   units    metres
//   source   the sagitta of the Earth's curve, d^2 / 2R; the rest made here
//   tested   tests/glsl/test_scene_water.py, against rays on a level plane in float64
//
// A ray that has gone into water has nothing in front of it but that surface, and ends on the bed:
// so a pixel shows water where the ground that it sees lies under some, and the surface is where
// the ray was at that level. No mesh is drawn, and a shore is as sharp as the pixels: it lies
// where the heights are at the level, whatever the mesh makes of them. A sea has no end at the
// terrain's edges: there it goes on to the horizon, sinking as the Earth does.
//
// An eye under water sees none of it.
#include "maths/square.glsl"
#include "scene/surfaces.glsl"
#include "terrain/heightfield.glsl"
#include "water/sheet_reading.glsl"
#pragma kernel(output = "seen_water:rgba32f, state:rgba32f")

uniform sampler2D seen;    //! input
uniform sampler2D height;  //! input
uniform sampler2D water;   //! input

const float EARTH = 6360e3;  // radius [m]
const float DRY = -1e4;       // a depth where there is no water
const float BOTTOMLESS = 1e4;

bool on_terrain(vec2 place) {
    return all(lessThanEqual(abs(place / extent - 0.5), vec2(0.5001)));
}

// How far a ray goes until it leaves the square of the terrain, or 0 where it never is in it.
float leaves_at(vec3 ahead) {
    vec2 span = span_through(eye.xy, ahead.xy, extent);
    return span.x < span.y ? max(span.y, 0.0) : 0.0;
}

// The open sea beyond the terrain: `over` metres above it where the ray leaves, and sinking.
float sea_beyond(float over, float rise) {
    float inside = rise * rise - 2.0 * over / EARTH;
    if (rise >= 0.0 || inside < 0.0) return -1.0;
    return 2.0 * over / (-rise + sqrt(inside));
}

// Where a ray that ends at a point below the level was at it.
vec3 at_level(vec3 point, float level) {
    return eye + (point - eye) * min((eye.z - level) / max(eye.z - point.z, 1e-6), 1.0);
}

// The terrain, or what stands on it: in or under water?
vec4 over_ground(vec4 at, out vec4 state) {
    vec2 share = at.xy / extent;
    Sheet here = sheet_at(water, share);
    vec2 last = vec2(textureSize(height, 0) - 1);
    // On the terrain the heights decide, not the mesh's; what stands on it, by itself.
    float depth = here.level - (is_top(at.w) ? relief * height_at(height, share * last) : at.z);
    if (depth <= 0.0 || here.level >= eye.z || is_cut(at.w) && !is_open(here)) {
        state = vec4(depth > 0.0 ? DRY : min(depth, -1e-4), 0.0, 0.0, 0.0);
        return at;
    }
    state = vec4(depth, here.current, max(here.white, 0.0));
    vec3 point = at_level(at.xyz, here.level);
    // In front of the terrain there is no water but the sea.
    if (on_terrain(point.xy) || is_open(here)) return vec4(point, WATER);
    state = vec4(DRY, 0.0, 0.0, 0.0);
    return at;
}

// A ray that meets no terrain, and leaves its square under water or over it.
vec4 past_ground(vec4 at, vec3 ahead, out float depth) {
    float leaves = leaves_at(ahead);
    vec3 edge = eye + ahead * leaves;
    vec2 share = clamp(edge.xy / extent, 0.0, 1.0);
    Sheet there = sheet_at(water, share);
    depth = DRY;
    if (there.level >= eye.z) return at;
    vec3 point;
    if (leaves > 0.0 && edge.z < there.level) {
        point = at_level(edge, there.level);
        float ground = relief * height_at(height, share * vec2(textureSize(height, 0) - 1));
        if (!is_open(there) && (there.level <= ground || !on_terrain(point.xy))) return at;
    } else {
        float level = max(length(ahead.xy), 1e-6);
        float beyond = sea_beyond(edge.z - there.level, ahead.z / level);
        if (!is_open(there) || beyond < 0.0) return at;
        point = edge + ahead * (beyond / level);
    }
    depth = BOTTOMLESS;
    return vec4(point, WATER);
}

void kernel(ivec2 texel, out vec4 seen_water, out vec4 state) {
    vec4 at = texelFetch(seen, texel, 0);
    state = vec4(DRY, 0.0, 0.0, 0.0);
    seen_water = at;
    if (is_broken(at.w)) return;
    if (!is_sky(at.w)) {
        seen_water = over_ground(at, state);
        return;
    }
    vec2 clip = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
    vec4 far = world_from_clip * vec4(clip, 1.0, 1.0);
    seen_water = past_ground(at, normalize(far.xyz / far.w - eye), state.x);
}
