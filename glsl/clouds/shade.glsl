// clouds/shade.glsl -- what clouds leave of the sun's beam, at every texel of the terrain.
//
//   gives    overhead: multiplies the sun's light; of a daylight, whose sun the cover dims
//            already, the share over the clouds' mean, so above 1 between clouds
//   needs    clouds/shadow.glsl, lighting/daylight_reading.glsl, terrain/heightfield.glsl; a
//            height 0..1, clouds by clouds/field and clouds/drift
//   units    metres
//   source   see clouds/shadow.glsl
//   tested   tests/glsl/test_cloud_shadows.py: where the sun's ray meets them; their mean
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "overhead:r16f")

uniform sampler2D height;    //! input
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap")
uniform sampler2D drift;     //! input
#include "lighting/parameters/sun.glsl"

float kernel(ivec2 texel) {
    vec2 place = place_on(textureSize(height, 0), texel, size);
    vec3 point = vec3(share_of_texel(texel, size) * extent, relief * height_at(height, place));
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    float left = cloud_transmittance(cloud, wind, point, light);
    return wired_daylight ? left / cloud_mean(cloud) : left;
}
