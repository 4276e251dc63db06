// scene/shaded/cloud_shadow.glsl -- how much of the sun clouds leave at each pixel.
//
//   gives    shadow, 1 for none: that of clouds and another together
//   needs    clouds/shadow.glsl, lighting/daylight_reading.glsl, scene/surfaces.glsl; seen, a
//            cloud and its drift; a daylight and another shadow, if there are
//   units    metres; 0..1, under a daylight over the mean of all clouds
//   source   clouds/shadow.glsl
//   tested   tests/glsl/test_cloud_shadows.py, tests/glsl/test_scene.py
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "scene/surfaces.glsl"
#pragma kernel(output = "shadow:r32f")

uniform sampler2D seen;          //! input
uniform sampler2D cloud;         //! input("linear", "repeat", "mipmap")
uniform sampler2D drift;         //! input
uniform sampler2D other_shadow;  //! input("white")
#include "clouds/parameters/drawn.glsl"
#include "lighting/parameters/sun.glsl"

float kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    float other = wired_other_shadow ? texelFetch(other_shadow, texel, 0).r : 1.0;
    if (clouds == 0 || is_sky(at.w)) return other;
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    // A daylight's sun is dimmed by the mean of all clouds already.
    return other * (wired_daylight ? cloud_share(cloud, wind, at.xyz, to_sun)
            : cloud_transmittance(cloud, wind, at.xyz, to_sun));
}
