// scene/water/heaven.glsl -- the sky over the water in all directions, for what it mirrors.
//
//   gives    heaven: the sky without sun and clouds, over it what clouds of two thicknesses show
//            there; each by azimuth along x and the root of the sine of the elevation along y
//   needs    clouds/crossing.glsl, clouds/heap_light.glsl, clouds/layer_form.glsl,
//            clouds/shadow.glsl, clouds/sunlight.glsl, lighting/daylight_sky.glsl,
//            scene/water/heaven_reading.glsl; a daylight and its tables, a tile of clouds and a
//            drift, if there are
//   units    light as of lighting/daylight
//   source   see scene/sky and clouds/layer
//   tested   tests/glsl/test_scene_water.py: as bright as the clouds of scene/sky
//
// A picture of the sky has only what is in front of the camera, and a part of a picture less: the
// water mirrors what is over it and behind. The sky is smooth, so few texels do; where the clouds
// are, the tile of clouds says to each pixel.
#include "clouds/crossing.glsl"
#include "clouds/heap_light.glsl"
#include "clouds/layer_form.glsl"
#include "clouds/shadow.glsl"
#include "clouds/sunlight.glsl"
#include "lighting/daylight_sky.glsl"
#include "scene/water/heaven_reading.glsl"
#pragma kernel(output = "heaven:rgba16f")

uniform sampler2D daylight;  //! input("black")
uniform sampler2D dome;      //! input("black")
uniform sampler2D columns;   //! input("black")
uniform sampler2D bounced;   //! input("black")
uniform sampler2D drift;     //! input("black")
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap", "white")
#include "clouds/parameters/drawn.glsl"
uniform vec3 zenith = vec3(0.105, 0.245, 0.56);  //! colour group("Sky") Where no daylight says it
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);   //! colour group("Sky") Likewise

const float LOWEST_SUN = 0.1;
const float AROUND = 0.5;        // how thick clouds are around one, over how thick it is
const float OUT_OF_SIDE = 0.35;  // of the tallest, from a side that is seen to the sun

vec3 clear_towards(vec3 towards, float height) {
    if (!wired_daylight) return mix(horizon, zenith, 1.0 - exp(-3.0 * towards.z));
    if (clouds == 0 || !wired_dome) return sky_towards(daylight, towards, height);
    vec3 sun = texelFetch(daylight, ivec2(0), 0).rgb;
    return weather(daylight).adapted * dome_at(dome, 0, towards, sun, height);
}

// What is seen of a cloud from below: its foot straight up, more of its side the lower one looks.
vec3 cloud_of(float thickness, vec3 towards, CloudLight light) {
    // Where clouds stand side by side, no more than the foot.
    float hidden = 1.0 - cloud_mean(cloud);
    float up = thickness * mix(mix(0.6, 0.15, towards.z), 0.1, hidden);
    float whole = depth_straight_up(thickness);
    float above = whole - depth_straight_up(up);
    // To the sun the nearer way: up through the cloud, or out through a side where that is free.
    float over = above / max(light.to_sun.z, LOWEST_SUN);
    float depth = mix(min(over, CLOUD_DEPTH * OUT_OF_SIDE), over, hidden);
    float around = thickness * mix(AROUND, 1.0, hidden);
    float from_sun = sun_in_heap(depth, above, whole, around, light.to_sun.z,
                                 dot(towards, light.to_sun), towards.z);
    float from_below = share_from_below(above, whole);
    return from_sun * light.sun + (1.0 - from_below) * light.above + from_below * light.below;
}

vec4 kernel(ivec2 texel) {
    ivec2 part = ivec2(size.x, size.y / SKIES);
    int which = texel.y / part.y;
    vec3 towards = heaven_direction(ivec2(texel.x, texel.y - which * part.y), part);
    float from = 0.001 * max(base_elevation, 0.0);
    vec3 clear = clear_towards(towards, from);
    bool drawn = clouds != 0 && wired_drift && wired_cloud && wired_columns && wired_daylight;
    if (which == CLEAR_SKY || !drawn) return vec4(clear, 1.0);
    float height = 0.001 * (base_elevation + texelFetch(drift, ivec2(0), 0).z + CLOUD_MIDDLE);
    vec2 span = layer_crossing(from, max(towards.z, 1e-4), height, height + 1e-3);
    if (span.y <= span.x) return vec4(clear, 1.0);
    CloudLight light = cloud_light(daylight, columns, bounced, from, towards, span.x, height);
    // Far clouds fade into the air before them, the sooner the hazier it is.
    float left = exp(-span.x * weather(daylight).turbidity / 110.0);
    float thickness = which == THIN_SKY ? THIN_CLOUD : THICK_CLOUD;
    // And the clouds are over that air: of the sun it has what they leave.
    vec3 air = clear * mix(1.0, cloud_mean(cloud), left);
    return vec4(mix(air, cloud_of(thickness, towards, light), left), 1.0);
}
