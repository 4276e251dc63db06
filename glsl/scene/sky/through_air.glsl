// scene/sky/through_air.glsl -- clouds with the air that is in front of them.
//
//   gives    picture: their light as it comes to the eye, and in alpha what they leave of the sky
//   needs    clouds/crossing.glsl, clouds/layer_form.glsl, scene/air_reading.glsl; the camera;
//            clouds, a drift, scene/air
//   units    light as of lighting/daylight
//   source   see scene/air
//   tested   tests/glsl/test_cloud_pictures.py: far clouds are the colour of the air
//
// Air in front of a cloud is that of the sky, which the picture has where no cloud is: so no more
// of it than the cloud hides.
#include "clouds/crossing.glsl"
#include "clouds/layer_form.glsl"
#include "scene/air_reading.glsl"
#pragma kernel(output = "picture:rgba16f")

uniform sampler2D flat_clouds;    //! input
uniform sampler2D heaped_clouds;  //! input
uniform sampler2D scattered;      //! input("linear")
uniform sampler2D left;           //! input("linear")
uniform sampler2D drift;          //! input
uniform int clouds = 2;           //! menu("none", "flat", "heaped")
                                  //! Which of the two

vec4 kernel(ivec2 texel) {
    ivec2 last = (clouds == 1 ? textureSize(flat_clouds, 0) : textureSize(heaped_clouds, 0)) - 1;
    vec4 cloud = clouds == 1 ? texelFetch(flat_clouds, min(texel, last), 0)
            : texelFetch(heaped_clouds, min(texel, last), 0);
    if (cloud.a >= 0.9995) return cloud;
    vec2 share = (vec2(texel) + 0.5) / vec2(size);
    vec4 away = world_from_clip * vec4(share * 2.0 - 1.0, 1.0, 1.0);
    vec3 ahead = normalize(away.xyz / away.w - eye);
    float height = 0.001 * max(base_elevation + eye.z, 0.0);
    float base = 0.001 * (base_elevation + texelFetch(drift, ivec2(0), 0).z);
    float rise = over_horizon(ahead, height, base).z;
    vec2 span = layer_crossing(height, rise, base, base + 0.001 * CLOUD_TALL);
    Aerial air = aerial(scattered, left, share, 1000.0 * max(span.x, 0.0));
    return vec4(cloud.rgb * air.left + (1.0 - cloud.a) * air.scattered, cloud.a);
}
