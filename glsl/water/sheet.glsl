// water/sheet.glsl -- lakes, rivers and simulated water as one surface with smooth shores.
//
//   gives    water, as water/sheet_reading has it
//   needs    maths/nodes.glsl, terrain/heightfield.glsl, terrain/maps.glsl, water/texels.glsl,
//            water/sheet_reading.glsl; a height 0..1; a depth (water/lakes, or what a simulation
//            gives), a river and its width (water/rivers) with its receivers, if there are
//   units    metres; metres a second
//   source   speed by slope and depth: Manning 1891, with 0.04 of natural streams; depth by width:
//            Leopold and Maddock 1953, USGS Professional Paper 252, figures 5 and 8: about a
//            twentieth, and less of wide rivers; the rest made here
//   tested   tests/glsl/test_water_sheet.py: shores lie where the depth of a lake is 0, and a
//            river is as wide over a sea as without one
//
// A lake's level is known where it is wet. On dry texels around it, it goes on as the mean of the
// wet ones nearby, but not over ground that lies much lower, at the outlet. So between a wet texel
// and a dry one the surface meets the ground where it would in nature. A river lies on the ground
// as a film, of which more than a half of the share of a texel is wet: narrower ones than that are
// for texturing/waters. Only beside a river does dry ground lie little above the water.
#include "maths/nodes.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#include "water/sheet_reading.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "water:rgba32f", level = "sea_level")

uniform sampler2D height;    //! input
uniform sampler2D depth;     //! input("zero")
uniform sampler2D river;     //! input("zero")
uniform sampler2D width;     //! input("zero")
uniform sampler2D receiver;  //! input("zero")
uniform float shallowest = 0.05;  //! slider(0, 5) step(0.01) unit("m")
                                  //! A depth below it is taken for dry
uniform bool sea = false;         //! group("Sea") Whether there is a sea too
uniform float sea_level = 0.0;    //! slider(-500, 9000) step(0.1) unit("m") group("Sea")
                                  //! Height of its surface, as elevations are counted

const float DRY = 1e3;       // [m] below the ground: there is no water
const float EDGE = 0.3;      // [m] below the ground: no river, but one may be near
const float SPILL = 0.6;     // [m] below a lake's level ground still belongs to it
const int AROUND = 2;       // texels that a lake's level goes on
const float MANNING = 0.04;
const float WHITE_FROM = 0.02;  // slopes at which a river begins to run white, and all does
const float WHITE_ALL = 0.12;

float ground_at_share(vec2 share) {
    return relief * height_at(height, share * vec2(textureSize(height, 0) - 1));
}

// The level of standing water at a texel of `depth`: its own, or of the wet ones around it.
float level_of_node(ivec2 node) {
    ivec2 grid = textureSize(depth, 0);
    float ground = ground_at_share(share_of_texel(node, grid));
    float own = texelFetch(depth, node, 0).r;
    if (own > shallowest) return ground + own;
    vec2 total = vec2(0.0);
    for (int y = -AROUND; y <= AROUND; y++) {
        for (int x = -AROUND; x <= AROUND; x++) {
            ivec2 there = node + ivec2(x, y);
            if (!inside(there, grid)) continue;
            float found = texelFetch(depth, there, 0).r;
            if (found <= shallowest) continue;
            float level = ground_at_share(share_of_texel(there, grid)) + found;
            total += vec2(level, 1.0) / float(x * x + y * y);
        }
    }
    if (total.y <= 0.0) return ground - DRY;
    float level = total.x / total.y;
    return ground > level - SPILL ? level : ground - 0.5 * shallowest;
}

float lake_level(ivec2 texel) {
    Nodes around = nodes_around(place_on(textureSize(depth, 0), texel, size));
    float total = 0.0;
    int k = 0;
    do {
        total += weight_of(around, k) * level_of_node(node_at(around, k));
        k++;
    } while (k < around.count);
    return total;
}

// The way downhill of the ground, or along the receivers where those are wired.
vec2 downhill(ivec2 texel, vec2 slope) {
    if (!wired_receiver) return -slope / max(length(slope), 1e-6);
    ivec2 grid = textureSize(receiver, 0);
    Nodes around = nodes_around(place_on(grid, texel, size));
    vec2 total = vec2(0.0);
    int k = 0;
    do {
        ivec2 node = node_at(around, k);
        ivec2 next = texel_of(texelFetch(receiver, node, 0).r, grid);
        total += weight_of(around, k) * vec2(next - node) * spacing_of(grid, extent);
        k++;
    } while (k < around.count);
    return total / max(length(total), 1e-6);
}

// Whether a texel next to one with no river has some.
bool is_next_to_river(ivec2 texel) {
    float maximum = 0.0;
    for (int k = 0; k < 9; k++) {
        ivec2 there = clamp(texel + ivec2(k % 3, k / 3) - 1, ivec2(0), size - 1);
        maximum = max(maximum, map_at(river, there, size).r);
    }
    return maximum > 0.0;
}

vec4 kernel(ivec2 texel) {
    vec2 share = share_of_texel(texel, size);
    float ground = ground_at_share(share);
    float lake = wired_depth ? lake_level(texel) : ground - DRY;
    bool none = lake < ground - 0.9 * DRY;
    float covered = wired_river ? map_at(river, texel, size).r : 0.0;
    bool near = none && covered <= 0.0 && wired_river && is_next_to_river(texel);
    vec4 found = vec4(near ? ground - EDGE : lake, 0.0, 0.0, 0.0);
    if (covered > 0.0) {
        float wide = wired_width ? map_at(width, texel, size).r : 10.0;
        float deep = 0.06 * pow(max(wide, 0.1), 0.8);
        vec2 grid = vec2(textureSize(height, 0) - 1);
        vec2 slope = relief * slope_at(height, share * grid,
                                       spacing_of(textureSize(height, 0), extent),
                                       CENTRAL_DIFFERENCES);
        vec2 direction = downhill(texel, slope);
        float fall = max(dot(-slope, direction), 1e-4);
        float speed = min(pow(deep, 2.0 / 3.0) * sqrt(fall) / MANNING, 4.0);
        float level = ground + deep * (2.0 * covered - 1.0);
        if (level > found.x) {
            found = vec4(level, direction * speed, smoothstep(WHITE_FROM, WHITE_ALL, fall));
        }
    }
    float open = sea_level - base_elevation;
    none = none && covered <= 0.0 && !near;
    if (sea && (none || open >= found.x)) found = vec4(open, 0.0, 0.0, OPEN);
    return found;
}
