// clouds/seen.glsl -- heaped clouds as the eye sees them, by a march through their layer.
//
//   gives    clouds: the light that they send to the eye, and in alpha what of the sky behind they
//            leave; the air in front of them is left to what reads it
//   needs    clouds/crossing.glsl, clouds/shadow.glsl, clouds/sunlight.glsl; the camera; a tile of
//            clouds, a drift, a daylight and two of its tables
//   units    metres; light as of lighting/daylight
//   source   light that drops scatter often: sky/drops.glsl, in a layer that faces the sun and is
//            as deep as the cloud on the sun's ray; small noise that wears clouds away: Schneider
//            2015, "The Real-Time Volumetric Cloudscapes of Horizon Zero Dawn" (SIGGRAPH course);
//            offsets: Bayer 1973
//   tested   tests/glsl/test_cloud_pictures.py: the cover is that of the shadows, and light that
//            comes back from an even layer is that of photons
//
// Each pixel of four by four begins elsewhere in its first step, and clouds/smoothed takes the
// mean of sixteen: so few steps show no bands.
#include "clouds/crossing.glsl"
#include "clouds/shadow.glsl"
#include "clouds/sunlight.glsl"
#pragma kernel(output = "clouds:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D columns;   //! input
uniform sampler2D bounced;   //! input
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap")
uniform sampler2D drift;     //! input
uniform int steps = 16;      //! menu("8", "16", "32", "64") values(8, 16, 32, 64)
                             //! Steps through the layer
uniform float wear = 1.0;    //! slider(0, 2) step(0.05)
                             //! How much small noise wears the clouds' sides

const float LONGEST = 6.0;     // [km] what is marched through of the layer
const float FARTHEST = 300.0;  // [km] past any horizon

// Extinction as a share of the most, `up` in a cloud of a thickness, both 0..1 of the tallest.
float density_at(float thick, float up) {
    return clamp((thick - up) * 12.0, 0.0, 1.0) * smoothstep(0.0, 0.04, up);
}

float worn_density(vec2 at, float thick, float up, float shift, float level) {
    if (thick <= up * 0.9) return 0.0;
    // As fine upwards as sideways: what is above is taken from so far to the side.
    vec2 near = textureLod(cloud, at * 7.0 + up * shift * vec2(5.6, 4.2), level + 3.0).gb;
    vec2 finer = textureLod(cloud, at * 19.0 + up * shift * vec2(-13.3, 13.3), level + 4.0).gb;
    // The mean of the noise is near 0, so that the clouds keep their cover: heaps are 0.77.
    float noise = 0.7 * (0.77 - near.y) + 0.6 * (0.5 - near.x) + 0.5 * (0.77 - finer.y);
    return density_at(thick - wear * noise * (0.25 + 0.75 * up), up);
}

float bayer(ivec2 texel) {
    ivec2 b = texel & 3;
    int mixed = b.x ^ b.y;
    int order = 4 * ((mixed & 1) * 2 + (b.y & 1)) + ((mixed >> 1) & 1) * 2 + ((b.y >> 1) & 1);
    return (float(order) + 0.5) / 16.0;
}

vec3 direction_of(vec2 pixel) {
    vec4 away = world_from_clip * vec4(pixel / vec2(size) * 2.0 - 1.0, 1.0, 1.0);
    return normalize(away.xyz / away.w - eye);
}

vec4 kernel(ivec2 texel) {
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
    // A whole level: one look at the tile in place of two.
    float level = floor(max(log2(max(pixel, 1e-3) / texel_wide), 0.0) + 0.5);
    float step_of = 1000.0 * min(span.y - span.x, LONGEST) / float(steps);
    float per_metre = CLOUD_DEPTH / CLOUD_TALL;
    float sideways = CLOUD_TALL / wind.w;
    float phase = drops_phase_wide(together);
    float transmittance = 1.0;
    // What the eye receives of the sun, of sky and ground together, and of the ground.
    vec3 part = vec3(0.0);
    for (int k = 0; k < steps; k++) {
        float path = 1000.0 * span.x + (float(k) + bayer(texel)) * step_of;
        float up = (1000.0 * (height_along(from, ahead.z, 0.001 * path) - base)) / CLOUD_TALL;
        vec2 at = tile_of(eye.xy + ahead.xy * path, wind);
        float thick = textureLod(cloud, at, level).r;
        float much = worn_density(at, thick, up, sideways, level);
        if (much < 0.004) continue;
        // Towards the sun: three steps, as far as the tallest cloud is thick.
        float depth = 0.0;
        for (int s = 0; s < 3; s++) {
            float start = s == 0 ? 0.0 : s == 1 ? 100.0 : 300.0;
            float long_ = s == 0 ? 100.0 : s == 1 ? 200.0 : 600.0;
            vec3 to = to_sun * (start + 0.5 * long_);
            float there = textureLod(cloud, at + to.xy / wind.w, level).r;
            depth += long_ * density_at(there, up + to.z / CLOUD_TALL);
        }
        depth *= per_metre;
        float behind = CLOUD_DEPTH * mix(0.5 * thick, up, clamp(to_sun.z, 0.0, 1.0));
        Diffuse around = diffuse_of_beam(depth, depth + behind, 1.0);
        float from_sun = phase * exp(-depth) + around.mean + WIDE_G * around.down * together;
        float from_below = share_from_below(CLOUD_DEPTH * max(thick - up, 0.0),
                                            CLOUD_DEPTH * max(thick, up));
        float left = exp(-much * per_metre * step_of);
        part += transmittance * (1.0 - left) * vec3(3.14159265 * from_sun, 1.0, from_below);
        transmittance *= left;
        if (transmittance < 0.01) break;
    }
    if (transmittance == 1.0) return vec4(0.0, 0.0, 0.0, 1.0);
    CloudLight light = cloud_light(daylight, columns, bounced, from, ahead, span.x, base);
    vec3 found = part.x * light.sun + (part.y - part.z) * light.above + part.z * light.below;
    return vec4(found + aureole(light.sun, transmittance, together), transmittance);
}
