// scene/shaded/wet_film.glsl -- the sky, mirrored by films of water on the ground.
//
//   gives    lit, linear light
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, lighting/sun.glsl,
//            scene/footprint.glsl, scene/ground_reading.glsl, scene/surfaces.glsl,
//            water/fresnel.glsl; lit, seen, ground, and bumps, in w the share of a pixel under a
//            film; a wetness, without which no ground has one; a daylight, if there is one
//   units    metres; light without unit, 1 for white
//   source   water/fresnel.glsl
//   tested   tests/glsl/test_near.py
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "water/fresnel.glsl"
#pragma kernel(output = "lit:rgba32f")

uniform sampler2D lit;      //! input
uniform sampler2D seen;     //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D bumps;    //! input
uniform sampler2D wetness;  //! input
uniform sampler2D daylight; //! input("black")
#include "lighting/parameters/skylight.glsl"

const float MIN_RISE = 0.02;  // of mirrored rays: bumps do not mirror the ground

vec4 kernel(ivec2 texel) {
    vec4 shown = texelFetch(lit, texel, 0);
    vec4 bump = texelFetch(bumps, texel, 0);
    vec4 at = texelFetch(seen, texel, 0);
    if (!wired_wetness || bump.w <= 0.0 || !is_top(at.w)) return shown;
    if (skips_rest()) return vec4(0.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    float pixel = distance(eye, at.xyz) * length(ray.up) / length(ray.ahead);
    Ground around = ground_at(ground, at.xy, extent, pixel);
    vec3 normal = normal_of_slope(around.slope + bump.xy);
    vec3 to_eye = normalize(eye - at.xyz);
    vec3 mirrored = reflect(-to_eye, normal);
    mirrored = normalize(vec3(mirrored.xy, max(mirrored.z, MIN_RISE)));
    vec3 sky = wired_daylight ? sky_towards(daylight, mirrored, 0.001 * (base_elevation + at.z))
            : sky_colour;
    float share = bump.w * fresnel_of_water(dot(normal, to_eye));
    return vec4(mix(shown.rgb, ambient * around.sky * sky, share), 1.0);
}
