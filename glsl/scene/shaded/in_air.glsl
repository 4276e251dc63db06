// scene/shaded/in_air.glsl -- the scene through the air: what is lit, and the sky behind it.
//
//   gives    frame, linear light
//   needs    lighting/daylight_sky.glsl, maths/number.glsl, scene/air_reading.glsl,
//            scene/surfaces.glsl, view/surface.glsl; seen, lit and a sky; a daylight, or the air,
//            if there are
//   units    metres; light without unit, 1 for white
//   source   scene/air_reading.glsl; the haze as view/surface.glsl has it
//   tested   tests/glsl/test_scene.py, against view/terrain and against float64
//
// The picture of the sky has its own air already.
#include "lighting/daylight_sky.glsl"
#include "maths/number.glsl"
#include "scene/air_reading.glsl"
#include "scene/surfaces.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "frame:rgba16f")

uniform sampler2D seen;       //! input
uniform sampler2D lit;        //! input
uniform sampler2D sky;        //! input
uniform sampler2D scattered;  //! input("linear", "black")
uniform sampler2D left;       //! input("linear", "black")
uniform sampler2D daylight;   //! input("black")
#include "view/parameters/haze.glsl"

vec3 in_air(vec3 light, vec2 share, float eye_distance);

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (is_sky(at.w)) return vec4(texelFetch(sky, texel, 0).rgb, 1.0);
    vec3 light = texelFetch(lit, texel, 0).rgb;
    if (is_broken(at.w) || !is_number(light.r + light.g + light.b)) {
        return vec4(NOT_A_NUMBER, 1.0);
    }
    vec2 share = (vec2(texel) + 0.5) / vec2(size);
    return vec4(in_air(light, share, distance(eye, at.xyz)), 1.0);
}

// What comes to the eye of a light at a place of the picture, 0..1.
vec3 in_air(vec3 light, vec2 share, float eye_distance) {
    if (wired_scattered && wired_left) {
        Aerial air = aerial(scattered, left, share, eye_distance);
        return light * air.left + air.scattered;
    }
    if (haze <= 0.0) return light;
    vec3 air = wired_daylight ? horizon_of(daylight, 0.001 * (base_elevation + eye.z)) : horizon;
    return through_air(light, air, haze, eye_distance, extent);
}
