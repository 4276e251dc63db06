// What woods make of a part's ground: what is beyond the last trees, and what they take of the light.
#include "trees.glsl"
#include "trees/wood_reading.glsl"
uniform bool wooded;
uniform sampler2D woods;     // of the part: density, what the terrain leaves of the sun
uniform sampler2D table;     // trees/wood

// Of a wood as seen from a vertex.
struct Wood {
    float hides;   // depth of what is not drawn as single trees, over the density
    vec2 below;    // of sun and sky, what the ground receives below the leaves
    vec3 light;    // of what is seen of it
};

const float THINNEST = 0.05;  // where there are no trees, it hides as where there are a few

vec3 raised(vec3 towards) { return normalize(vec3(towards.xy, max(towards.z, LOWEST))); }

// `here`: density, what the terrain leaves of the sun; `open`: what clouds leave of it.
Wood wood_from(vec3 away, float metres, vec2 here, float open) {
    vec3 towards_eye = raised(-away / max(length(away), 1e-3));
    float density = max(here.x, THINNEST);
    Stand all = stand_at(density, metres);
    Stand drawn = drawn_of(all, length(away + level_eye));
    float depth = max(depth_towards(all, towards_eye) - depth_towards(drawn, towards_eye), 0.0);
    float sunward = to_sun.z > 0.0 ? depth_towards(all, raised(to_sun)) : 0.0;
    vec2 below = exp(-vec2(sunward, depth_towards(all, SKY_FROM)) * (here.x / density));
    vec2 light = wood_at(table, towards_eye, to_sun, density, needles_only(needles_from, metres));
    vec3 leaves = mix(leaf_colours[0], leaf_colours[1],
                      needle_area(needle_share(needles, needles_from, metres)));
    vec3 lit = sun_light * (here.y * open * light.x) + sky_light * light.y;
    return Wood(depth / density, below, leaves * lit);
}
