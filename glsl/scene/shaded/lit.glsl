// scene/shaded/lit.glsl -- the light from the surface in each pixel, before the air.
//
//   gives    lit, linear light; 0 for the sky
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, lighting/sun.glsl,
//            scene/footprint.glsl, scene/ground_reading.glsl, scene/near/self_shadow.glsl,
//            scene/surfaces.glsl, view/surface.glsl; seen, ground, albedo and bumps; a daylight, a
//            light, a shadow, and what is taken, if there are
//   units    metres; slopes in metres over metres; light without unit, 1 for white
//   source   deferred: Saito and Takahashi 1990, "Comprehensible Rendering of 3-D Shapes"
//            (SIGGRAPH); the light as lighting/shade has it
//   tested   tests/glsl/test_scene.py, against view/terrain and against float64
//
//     light = albedo (sun colour gain V S max(0, N L) + sky colour ambient F)
//
// N is the normal of the ground under the pixel, not of a texel of a map. `bumps` are slopes added
// to the ground's own, as of gravel, and in z their variance, for the shadows that they throw on
// each other. S, `shadow`, is what else keeps the sun from a pixel: clouds, trees. `taken` is of
// surfaces that are no planes, as leaves: how much of the sun goes with max(0, N L), how much does
// not, and how much of the sky there is. Where a `light` is wired, and no `visibility`, a
// technique of lighting/ has lit the terrain already, and its map is taken instead.
//
// 32 bits, since films of water and air are added to it before it is rounded.
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/near/self_shadow.glsl"
#include "scene/surfaces.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "lit:rgba32f")

uniform sampler2D seen;        //! input
uniform sampler2D ground;      //! input("linear", "mipmap")
uniform sampler2D albedo;      //! input
uniform sampler2D bumps;       //! input
uniform sampler2D shadow;      //! input("white")
uniform sampler2D taken;       //! input("zero")
uniform sampler2D light;       //! input("linear", "mipmap", "white")
uniform sampler2D visibility;  //! input("white")
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"

vec3 light_on(vec4 at, Ground around, vec4 bump, float sun_share, vec3 takes);
vec3 light_of_map(vec3 point, vec2 slope, PixelRay ray);

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (is_sky(at.w) || is_broken(at.w)) return vec4(0.0);
    vec3 colour = texelFetch(albedo, texel, 0).rgb;
    if (is_cut(at.w)) return vec4(wired_daylight ? colour * level_light(daylight) : colour, 1.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    float pixel = distance(eye, at.xyz) * length(ray.up) / length(ray.ahead);
    Ground around = ground_at(ground, at.xy, extent, pixel);
    if (wired_light && !wired_visibility && is_top(at.w)) {
        return vec4(colour * light_of_map(at.xyz, around.slope, ray), 1.0);
    }
    vec4 bump = texelFetch(bumps, texel, 0);
    float sun_share = wired_shadow ? texelFetch(shadow, texel, 0).r : 1.0;
    vec3 takes = wired_taken ? texelFetch(taken, texel, 0).xyz : vec3(1.0, 0.0, 1.0);
    return vec4(colour * light_on(at, around, bump, sun_share, takes), 1.0);
}

// What a white surface sends on: `sun_share` is what shadows leave of the sun.
vec3 light_on(vec4 at, Ground around, vec4 bump, float sun_share, vec3 takes) {
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    float cosine;
    if (is_object(at.w)) {
        cosine = dot(normal_of(at.w), from.direction);
    } else {
        vec3 even = normal_of_slope(around.slope);
        vec3 normal = normal_of_slope(around.slope + bump.xy);
        cosine = dot(normal, from.direction);
        if (bump.z > 0.0) {
            cosine = facing_of_bumps(normal, even, from.direction)
                    * sun_past_bumps(dot(even, from.direction), bump.z);
            from.sky *= sky_on_bumps(normal, even, from.direction);
        }
    }
    float facing = takes.x * max(0.0, cosine) + takes.y;
    // Where nothing else says so, a sun below the horizon is hidden.
    if (from.direction.z < 0.0) facing = 0.0;
    vec3 direct = from.sun * (gain * around.sun * sun_share * facing);
    return direct + from.sky * (ambient * around.sky * takes.z);
}

vec3 light_of_map(vec3 point, vec2 slope, PixelRay ray) {
    ivec2 texels = textureSize(light, 0);
    Footprint foot = footprint_of(ray, point - eye, normal_of_slope(slope));
    float level = level_of(foot, vec2(texels - 1) / extent) + SHARPER;
    return textureLod(light, drape_uv(point.xy / extent, texels), level).rgb;
}
