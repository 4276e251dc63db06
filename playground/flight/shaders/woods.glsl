// What woods make of a part's ground: what is beyond the last trees, and what they take of the
// light.
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

// `here`: density, what the terrain leaves of the sun; `open`: what clouds leave of it.
Wood wood_from(vec3 away, float metres, vec2 here, float open) {
    vec3 towards_eye = -away / max(length(away), 1e-3);
    float rise = max(towards_eye.z, LOWEST);
    float density = max(here.x, THINNEST);
    Stand around = stand_at(density, metres);
    Stand drawn = drawn_of(around, length(away + level_eye));
    Depths depths = Depths(depth_towards(around, towards_eye, rise),
                           depth_towards(around, to_sun, max(to_sun.z, LOWEST)),
                           depth_of_sky(around));
    float hides = max(depths.sight - depth_towards(drawn, towards_eye, rise), 0.0) / density;
    vec2 below = exp(-vec2(depths.sun, depths.sky) * (here.x / density));
    vec4 in_sight = others_in_sight(species_at(metres));
    float needled = in_sight.z + in_sight.w;
    vec2 light = wood_at(table, towards_eye, to_sun, depths, needled);
    float sun = here.y * open * leaf_phase(towards_eye, to_sun) * light.x;
    vec3 lit = sun_light * sun + sky_light * light.y;
    return Wood(hides, below, mix(leaf_colours[0], leaf_colours[1], needled) * lit);
}
