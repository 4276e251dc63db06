// scene/shaded.glsl -- each pixel of the scene in its light: lit once, whatever was drawn there.
//
//   gives    frame, linear light
//   needs    scene/footprint.glsl, scene/ground_reading.glsl, scene/surfaces.glsl,
//            lighting/sun.glsl, lighting/daylight_reading.glsl, lighting/daylight_sky.glsl,
//            scene/air_reading.glsl, clouds/shadow.glsl, view/surface.glsl; seen, ground, albedo
//            and a sky; a daylight, a light, bumps, a shadow, clouds, or the air if there are
//   units    metres; slopes in metres over metres; light without unit, 1 for white
//   source   deferred: Saito and Takahashi 1990, "Comprehensible Rendering of 3-D Shapes"
//            (SIGGRAPH); the light as lighting/shade has it
//   tested   tests/glsl/test_scene.py, against view/terrain and against float64
//
// light = sun colour gain V max(0, N L) + sky colour ambient F, where N is that of the ground
// under the pixel and not of a texel of a map. `bumps` are slopes added to the ground's own, as
// of gravel; `shadow` is what else keeps the sun from a pixel: clouds, trees. Both are pictures
// of pixels, made by passes that read `seen`; so is `taken`, of surfaces that are no planes, as
// leaves: how much of the sun goes with max(0, N L), how much does not, and how much of the sky
// there is. Where a `light` is wired, and no `visibility`, a technique of lighting/ has lit the
// terrain already, and that is taken instead. Air by scene/air takes the place of the haze.
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "maths/number.glsl"
#include "scene/air_reading.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "frame:rgba16f")

uniform sampler2D seen;        //! input
uniform sampler2D ground;      //! input("linear", "mipmap")
uniform sampler2D albedo;      //! input
uniform sampler2D sky;         //! input
uniform sampler2D light;       //! input("linear", "mipmap", "white")
uniform sampler2D visibility;  //! input("white")
uniform sampler2D bumps;       //! input("zero")
uniform sampler2D shadow;      //! input("white")
uniform sampler2D taken;       //! input("zero")
uniform sampler2D cloud;       //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D drift;       //! input("black")
uniform sampler2D scattered;   //! input("linear", "black")
uniform sampler2D left;        //! input("linear", "black")
#include "clouds/parameters/drawn.glsl"
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "view/parameters/haze.glsl"

// What a surface that faces `normal` sends on, of a white one.
vec3 received(Sunlight from, vec3 normal, Ground around, float sun_share, vec3 takes) {
    float facing = takes.x * max(0.0, dot(normal, from.direction)) + takes.y;
    // Where nothing else says so, a sun below the horizon is hidden.
    if (from.direction.z < 0.0) facing = 0.0;
    vec3 direct = from.sun * (gain * around.sun * sun_share * facing);
    return direct + from.sky * (ambient * around.sky * takes.z);
}

// `bump` is what the pixel's slope has beyond the ground's, `sun_share` what no shadow takes.
vec3 light_at(vec4 at, PixelRay ray, vec2 bump, float sun_share, vec3 takes) {
    if (is_cut(at.w)) return wired_daylight ? level_light(daylight) : vec3(1.0);
    float wide = distance(eye, at.xyz) * length(ray.up) / length(ray.ahead);
    Ground around = ground_at(ground, at.xy, extent, wide);
    vec3 normal = normal_of_slope(around.slope);
    if (wired_light && !wired_visibility && is_top(at.w)) {
        ivec2 texels = textureSize(light, 0);
        Footprint foot = footprint_of(ray, at.xyz - eye, normal);
        float level = level_of(foot, vec2(texels - 1) / extent) + SHARPER;
        return textureLod(light, drape_uv(at.xy / extent, texels), level).rgb;
    }
    if (is_object(at.w)) normal = normal_of(at.w);
    else normal = normal_of_slope(around.slope + bump);
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    if (wired_cloud && wired_drift && clouds != 0) {
        vec4 wind = texelFetch(drift, ivec2(0), 0);
        // A daylight's sun is dimmed by the mean of all clouds already.
        sun_share *= wired_daylight ? cloud_share(cloud, wind, at.xyz, from.direction)
                : cloud_transmittance(cloud, wind, at.xyz, from.direction);
    }
    return received(from, normal, around, sun_share, takes);
}

vec3 in_air(vec3 shown, vec3 place, ivec2 texel) {
    float far = distance(eye, place);
    if (wired_scattered && wired_left) {
        Aerial air = aerial(scattered, left, (vec2(texel) + 0.5) / vec2(size), far);
        return shown * air.left + air.scattered;
    }
    if (haze <= 0.0) return shown;
    vec3 air = wired_daylight ? horizon_of(daylight, 0.001 * (base_elevation + eye.z)) : horizon;
    return through_air(shown, air, haze, far, extent);
}

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (is_sky(at.w)) return vec4(texelFetch(sky, texel, 0).rgb, 1.0);
    if (is_broken(at.w)) return vec4(NOT_A_NUMBER, 1.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    vec2 bump = wired_bumps ? texelFetch(bumps, texel, 0).xy : vec2(0.0);
    float sun_share = wired_shadow ? texelFetch(shadow, texel, 0).r : 1.0;
    vec3 takes = wired_taken ? texelFetch(taken, texel, 0).xyz : vec3(1.0, 0.0, 1.0);
    vec3 light = light_at(at, ray, bump, sun_share, takes);
    vec3 shown = texelFetch(albedo, texel, 0).rgb * light;
    if (!is_number(shown.r + shown.g + shown.b)) return vec4(NOT_A_NUMBER, 1.0);
    return vec4(in_air(shown, at.xyz, texel), 1.0);
}
