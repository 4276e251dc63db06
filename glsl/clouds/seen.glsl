// clouds/seen.glsl -- heaped clouds as the eye sees them, by a march through their layer.
//
//   gives    clouds: the light that they send to the eye, and in alpha what of the sky behind they
//            leave; the air in front of them is left to what reads it
//   needs    clouds/crossing.glsl, clouds/density.glsl, clouds/heap_light.glsl,
//            clouds/shadow.glsl, clouds/sunlight.glsl, scene/sky/hidden.glsl; the camera; a tile
//            of clouds, clouds/billows, a drift, a daylight and two of its tables
//   units    metres; light as of lighting/daylight
//   source   none: a march; see clouds/density.glsl and clouds/heap_light.glsl
//   tested   tests/glsl/test_cloud_pictures.py: the cover is that of the shadows, and light that
//            comes back from an even layer is that of photons; tests/glsl/test_cloud_light.py: and
//            from heaps
//
// Long steps find where a cloud may be, halves of the last one where it begins, and short ones go
// on from there: so its edge is sharp, and no step shows.
#include "clouds/crossing.glsl"
#include "clouds/density.glsl"
#include "clouds/heap_light.glsl"
#include "clouds/shadow.glsl"
#include "clouds/sunlight.glsl"
#include "scene/sky/hidden.glsl"
#pragma kernel(output = "clouds:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D columns;   //! input
uniform sampler2D bounced;   //! input
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap")
uniform sampler2D drift;     //! input
uniform sampler2D billows;   //! input("linear")
uniform sampler2D seen;      //! input("black")
uniform int steps = 16;      //! menu("8", "16", "32", "64") values(8, 16, 32, 64)
                             //! Steps through the layer
uniform float wear = 1.0;    //! slider(0, 2) step(0.05)
                             //! How much small heaps change the clouds' sides

const float LONGEST = 12.0;    // [km] what is marched through of the layer
const float FARTHEST = 300.0;  // [km] past any horizon
const int MOST_STEPS = 160;
const int MOST_CLOUDS = 6;     // one behind the other

vec3 direction_of(vec2 pixel) {
    vec4 far_point = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(far_point.xyz / far_point.w - eye);
}

struct Layer {
    vec3 ahead;
    vec4 wind;
    float from;   // height of the eye [km]
    float base;   // of the clouds [km]
    float level;   // of detail
    float coarse;  // the same in whole levels: one look at the tile in place of two
    float texel;   // of the tile [m]
    Wear wear;
};

struct Place {
    float under;    // how far under the cloud's surface, in the tallest; below 0 in the open
    bool near;      // a cloud may be here
    float density;  // 0..1 of the most extinction
    float up;       // over the base, in the tallest
    float thick;    // how thick the cloud is
};

Place cloud_in(Layer layer, float path) {
    float up = (1000.0 * (height_along(layer.from, layer.ahead.z, 0.001 * path) - layer.base))
            / CLOUD_TALL;
    vec2 at = tile_of(eye.xy + layer.ahead.xy * path, layer.wind);
    float thick = textureLod(cloud, at, layer.level).r;
    float maximum = 0.35 * (layer.wear.large + layer.wear.small) * (0.4 + 0.6 * up);
    // Lines of sight begin on the base, or just under it by rounding.
    if (thick + maximum < up || thick == 0.0 || up < -2e-3) {
        return Place(-1.0, false, 0.0, up, thick);
    }
    thick = worn(billows, layer.wear, at, thick, up, layer.wind.w);
    return Place(thick - up, true, density_at(thick, up), up, thick);
}

// The optical depth towards the sun, in steps that double; each is taken as the mean over its
// length, or the sides of clouds would show as many shades as there are steps.
float depth_towards(vec3 to_sun, Layer layer, vec2 at, float up, bool fine) {
    float depth = 0.0;
    float start = 0.0;
    float long_ = 60.0;
    for (int s = 0; s < 5; s++) {
        vec3 to = to_sun * (start + 0.5 * long_);
        vec2 there = at + to.xy / layer.wind.w;
        float height = up + to.z / CLOUD_TALL;
        float level = max(layer.coarse, floor(log2(0.5 * long_ / layer.texel) + 0.5));
        float thick = textureLod(cloud, there, level).r;
        if (s == 0 && fine) thick = worn(billows, layer.wear, there, thick, height, layer.wind.w);
        float steep = 1.0 / (1.0 / CLOUD_STEEP + 0.35 * long_ / CLOUD_TALL);
        depth += long_ * clamp(0.5 + (thick - height - 0.5 / CLOUD_STEEP) * steep, 0.0, 1.0)
                * min(thick * CLOUD_STEEP, 1.0);
        start += long_;
        long_ *= 2.0;
    }
    return depth * CLOUD_DEPTH / CLOUD_TALL;
}

// The parts of what is sent to the eye from a place: of the sun's beam, of all light from around,
// and what of that comes from the ground.
vec3 light_in(Layer layer, vec3 to_sun, float together, float path, Place here, bool fine) {
    vec2 at = tile_of(eye.xy + layer.ahead.xy * path, layer.wind);
    float depth = depth_towards(to_sun, layer, at, here.up, fine);
    float above = CLOUD_DEPTH * max(here.thick - here.up, 0.0);
    float whole = CLOUD_DEPTH * max(here.thick, here.up);
    float level = floor(log2(CLOUD_TALL / layer.texel) + 0.5);
    float around = textureLod(cloud, at, level).r;
    float from_sun = sun_in_heap(depth, above, whole, around, to_sun.z, together, layer.ahead.z);
    return vec3(from_sun, 1.0, share_from_below(above, whole));
}

// The first place at or after a distance where there is cloud; past the end if there is none.
float cloud_after(Layer layer, float path, float end, float long_, float short_) {
    float step_of = long_;
    float before = path;
    float open = 0.0;
    float under = 0.0;
    for (int k = 0; k < MOST_STEPS && path < end; k++) {
        Place here = cloud_in(layer, path);
        under = here.under;
        if (under > 0.0) break;
        open = under;
        // Near a cloud by short steps, from one short step after the last place in the open.
        if (here.near && step_of > short_) path = before;
        step_of = here.near ? short_ : long_;
        before = path;
        path += step_of;
    }
    if (path >= end || before == path) return path;
    for (int h = 0; h < 3; h++) {
        float middle = 0.5 * (before + path);
        float there = cloud_in(layer, middle).under;
        if (there > 0.0) {
            path = middle;
            under = there;
        } else {
            before = middle;
            open = there;
        }
    }
    // Where a straight line between the two meets the surface.
    return mix(before, path, open / min(open - under, -1e-6));
}

vec4 kernel(ivec2 texel) {
    if (wired_seen && sky_hidden(seen, texel, size)) return vec4(0.0, 0.0, 0.0, 1.0);
    if (skips_rest()) return vec4(0.0);
    vec3 ahead = direction_of(vec2(texel) + 0.5);
    float angle = distance(ahead, direction_of(vec2(texel) + vec2(0.5, 1.5)));
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    float from = 0.001 * max(base_elevation + eye.z, 0.0);
    float base = 0.001 * (base_elevation + wind.z);
    ahead = over_horizon(ahead, from, base);
    vec2 span = layer_crossing(from, ahead.z, base, base + 0.001 * CLOUD_TALL);
    if (span.y <= span.x || span.x > FARTHEST) return vec4(0.0, 0.0, 0.0, 1.0);
    vec3 to_sun = sun_direction(true, daylight, vec3(0.0));
    float together = dot(ahead, to_sun);
    float texel_wide = wind.w / float(textureSize(cloud, 0).x);
    float pixel = 1000.0 * span.x * angle;
    float end = 1000.0 * min(span.y, span.x + LONGEST);
    float search = clamp((end - 1000.0 * span.x) / float(steps), 50.0, 100.0 + 8.0 * span.x);
    // No cloud is so small that long steps now meet it and now do not.
    float level = max(log2(max(pixel, 0.3 * search) / texel_wide), 0.0);
    Layer layer = Layer(ahead, wind, from, base, level, floor(level + 0.5), texel_wide,
                        wear_of(wind.w, wear, pixel));
    float short_ = max(28.0, pixel);
    float per_metre = CLOUD_DEPTH / CLOUD_TALL;
    float transmittance = 1.0;
    // What the eye receives of the sun, of sky and ground together, and of the ground.
    vec3 part = vec3(0.0);
    float path = 1000.0 * span.x;
    // In parts: first to a cloud, then into it, so that pixels side by side do alike.
    for (int part_of = 0; part_of < MOST_CLOUDS && transmittance > 0.01; part_of++) {
        path = cloud_after(layer, path, end, search, short_);
        if (path >= end) break;
        // Both density and light are taken as straight lines from place to place, and the last
        // step ends at the surface: so the number of steps does not show.
        float step_of = short_;
        float under = 0.0;
        float before = 0.0;
        vec3 light_before = vec3(0.0);
        for (int k = 0; k < MOST_STEPS && transmittance > 0.01; k++) {
            path += step_of;
            Place here = cloud_in(layer, path);
            float share = here.under > 0.0 ? 1.0 : under / max(under - here.under, 1e-6);
            vec3 light = here.under > 0.0 ? light_in(layer, to_sun, together, path, here, k < 3)
                    : light_before;
            float depth = 0.5 * (before + here.density) * per_metre * step_of * share;
            vec3 mean_light = k == 0 ? light : 0.5 * (light + light_before);
            part += transmittance * (1.0 - exp(-depth)) * mean_light;
            transmittance *= exp(-depth);
            if (here.under <= 0.0) break;
            under = here.under;
            before = here.density;
            light_before = light;
            if (k > 1) step_of *= 1.3;
        }
    }
    if (transmittance == 1.0) return vec4(0.0, 0.0, 0.0, 1.0);
    CloudLight light = cloud_light(daylight, columns, bounced, from, ahead, span.x, base);
    vec3 found = part.x * light.sun + (part.y - part.z) * light.above + part.z * light.below;
    return vec4(found + aureole(light.sun, transmittance, together), transmittance);
}
