// scene/shaded.glsl -- each pixel of the scene in its light: lit once, whatever was drawn there.
//
//   gives    frame, linear light
//   needs    scene/footprint.glsl, scene/ground_reading.glsl, scene/surfaces.glsl,
//            scene/near/self_shadow.glsl, scene/near/wet.glsl, lighting/sun.glsl,
//            lighting/daylight_reading.glsl, lighting/daylight_sky.glsl,
//            scene/air_reading.glsl, clouds/shadow.glsl, view/surface.glsl,
//            water/fresnel.glsl; seen, ground, albedo and a sky; a daylight, a light, bumps, a
//            shadow, clouds, or the air if there are
//   units    metres; slopes in metres over metres; light without unit, 1 for white
//   source   deferred: Saito and Takahashi 1990, "Comprehensible Rendering of 3-D Shapes"
//            (SIGGRAPH); the light as lighting/shade has it
//   tested   tests/glsl/test_scene.py, against view/terrain and against float64
//
// light = sun colour gain V max(0, N L) + sky colour ambient F, where N is that of the ground
// under the pixel and not of a texel of a map. `bumps` are slopes added to the ground's own, as
// of gravel, in z their variance, for the shadows that they throw on each other, and in w the
// share under a film of water, where a wetness is wired; `shadow` is what else keeps the sun from
// a pixel: clouds, trees. Both are pictures of pixels, made by passes that read `seen`; so is
// `taken`, of surfaces that are no planes, as leaves: how much of the sun goes with max(0, N L),
// how much does not, and how much of the sky there is. Where a `light` is wired, and no
// `visibility`, a technique of lighting/ has lit the terrain already, and that is taken instead.
// Air by scene/air takes the place of the haze.
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "maths/number.glsl"
#include "scene/air_reading.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/near/self_shadow.glsl"
#include "scene/near/wet.glsl"
#include "scene/surfaces.glsl"
#include "view/surface.glsl"
#include "water/fresnel.glsl"
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
uniform sampler2D wetness;     //! input("zero")
uniform sampler2D cloud;       //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D drift;       //! input("black")
uniform sampler2D scattered;   //! input("linear", "black")
uniform sampler2D left;        //! input("linear", "black")
#include "clouds/parameters/drawn.glsl"
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "view/parameters/haze.glsl"

// What a surface sends on, of a white one, that faces the sun at a cosine.
vec3 received(Sunlight from, float cosine, Ground around, float sun_share, vec3 takes) {
    float facing = takes.x * max(0.0, cosine) + takes.y;
    // Where nothing else says so, a sun below the horizon is hidden.
    if (from.direction.z < 0.0) facing = 0.0;
    vec3 direct = from.sun * (gain * around.sun * sun_share * facing);
    return direct + from.sky * (ambient * around.sky * takes.z);
}

// The sky above wet ground, mirrored by its film; in a the share that the film throws back.
vec4 mirrored(vec4 at, vec3 normal, float film, Ground around, Sunlight from) {
    vec3 to_eye = normalize(eye - at.xyz);
    vec3 way = reflect(-to_eye, normal);
    way = normalize(vec3(way.xy, max(way.z, 0.02)));
    vec3 sky_there = wired_daylight
            ? sky_towards(daylight, way, 0.001 * (base_elevation + at.z)) : from.sky;
    return vec4(ambient * around.sky * sky_there, film * fresnel_of_water(dot(normal, to_eye)));
}

// What the pixel shows of a surface of that colour. `bump` is what its slope has beyond the
// ground's, `sun_share` what no shadow takes.
vec3 lit(vec4 at, vec3 colour_of, PixelRay ray, vec4 bump, float sun_share, vec3 takes) {
    if (is_cut(at.w)) return colour_of * (wired_daylight ? level_light(daylight) : vec3(1.0));
    float wide = distance(eye, at.xyz) * length(ray.up) / length(ray.ahead);
    Ground around = ground_at(ground, at.xy, extent, wide);
    vec3 normal = normal_of_slope(around.slope);
    if (wired_light && !wired_visibility && is_top(at.w)) {
        ivec2 texels = textureSize(light, 0);
        Footprint foot = footprint_of(ray, at.xyz - eye, normal);
        float level = level_of(foot, vec2(texels - 1) / extent) + SHARPER;
        return colour_of * textureLod(light, drape_uv(at.xy / extent, texels), level).rgb;
    }
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    float cosine;
    if (is_object(at.w)) {
        cosine = dot(normal_of(at.w), from.direction);
        bump = vec4(0.0);
    } else {
        vec3 own = normal_of_slope(around.slope + bump.xy);
        cosine = dot(own, from.direction);
        if (bump.z > 0.0) {
            cosine = facing_of_bumps(own, normal, from.direction)
                    * sun_past_bumps(dot(normal, from.direction), bump.z);
            from.sky *= sky_on_bumps(own, normal, from.direction);
        }
        normal = own;
    }
    if (wired_cloud && wired_drift && clouds != 0) {
        vec4 wind = texelFetch(drift, ivec2(0), 0);
        // A daylight's sun is dimmed by the mean of all clouds already.
        sun_share *= wired_daylight ? cloud_share(cloud, wind, at.xyz, from.direction)
                : cloud_transmittance(cloud, wind, at.xyz, from.direction);
    }
    vec3 shown = colour_of * received(from, cosine, around, sun_share, takes);
    if (!wired_wetness) return shown;
    vec4 film = mirrored(at, normal, bump.w, around, from);
    return mix(shown, film.rgb, film.a);
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
    if (skips_rest()) return vec4(0.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    vec4 bump = wired_bumps ? texelFetch(bumps, texel, 0) : vec4(0.0);
    float sun_share = wired_shadow ? texelFetch(shadow, texel, 0).r : 1.0;
    vec3 takes = wired_taken ? texelFetch(taken, texel, 0).xyz : vec3(1.0, 0.0, 1.0);
    vec3 shown = lit(at, texelFetch(albedo, texel, 0).rgb, ray, bump, sun_share, takes);
    if (!is_number(shown.r + shown.g + shown.b)) return vec4(NOT_A_NUMBER, 1.0);
    return vec4(in_air(shown, at.xyz, texel), 1.0);
}
