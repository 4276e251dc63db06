// scene/sky/through_air.glsl -- what is in front of the sky, with the air before it.
//
//   gives    picture: clouds and the ground beyond the terrain as they come to the eye, and in
//            alpha what they leave of the sky
//   needs    clouds/crossing.glsl, clouds/layer_form.glsl, lighting/daylight_weather.glsl,
//            scene/air_reading.glsl; the camera; clouds, a drift, a daylight, scene/air
//   units    light as of lighting/daylight
//   source   see scene/air
//   tested   tests/glsl/test_cloud_pictures.py: far clouds are the colour of the air
//
// Air in front of a cloud is that of the sky, which the picture has where no cloud is: so no more
// of it than the cloud hides. Half of the pixels on each axis are enough: all of it is soft.
#include "clouds/crossing.glsl"
#include "clouds/layer_form.glsl"
#include "lighting/daylight_weather.glsl"
#include "scene/air_reading.glsl"
#include "scene/sky/hidden.glsl"
#pragma kernel(output = "picture:rgba16f")

uniform sampler2D flat_clouds;    //! input
uniform sampler2D heaped_clouds;  //! input
uniform sampler2D daylight;       //! input
uniform sampler2D scattered;      //! input("linear")
uniform sampler2D left;           //! input("linear")
uniform sampler2D drift;          //! input("black")
uniform sampler2D seen;           //! input("black")
#include "clouds/parameters/drawn.glsl"
uniform vec3 beyond = vec3(0.07, 0.10, 0.05);  //! colour
                                  //! Of the flat ground beyond the terrain

vec4 cloud_at(ivec2 texel) {
    if (clouds == 0) return vec4(0.0, 0.0, 0.0, 1.0);
    ivec2 last = (clouds == 1 ? textureSize(flat_clouds, 0) : textureSize(heaped_clouds, 0)) - 1;
    return clouds == 1 ? texelFetch(flat_clouds, min(texel, last), 0)
            : texelFetch(heaped_clouds, min(texel, last), 0);
}

vec4 kernel(ivec2 texel) {
    if (wired_seen && sky_hidden(seen, texel, size)) return vec4(0.0, 0.0, 0.0, 1.0);
    if (skips_rest()) return vec4(0.0);
    vec2 share = (vec2(texel) + 0.5) / vec2(size);
    vec4 far_point = world_from_clip * vec4(share * 2.0 - 1.0, 1.0, 1.0);
    vec3 ahead = normalize(far_point.xyz / far_point.w - eye);
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    float base = 0.001 * (base_elevation + texelFetch(drift, ivec2(0), 0).z);
    float ground = distance_to_ground(height, ahead.z);
    vec4 found = vec4(0.0, 0.0, 0.0, 1.0);
    if (ground >= 0.0) {
        Aerial air = aerial(scattered, left, share, 1000.0 * ground);
        found = vec4(beyond * weather(daylight).level * air.left + air.scattered, 0.0);
        if (height < base) return found;
    }
    vec4 cloud = cloud_at(texel);
    if (cloud.a >= 0.9995) return found;
    float rise = over_horizon(ahead, height, base).z;
    vec2 span = layer_crossing(height, rise, base, base + 0.001 * CLOUD_TALL);
    Aerial air = aerial(scattered, left, share, 1000.0 * max(span.x, 0.0));
    return vec4(found.rgb * cloud.a + cloud.rgb * air.left + (1.0 - cloud.a) * air.scattered,
                found.a * cloud.a);
}
