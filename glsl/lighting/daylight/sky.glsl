// lighting/daylight/sky.glsl -- all of daylight in one texture: numbers, and the sky below them.
//
//   gives    daylight: row 0 as in lighting/daylight/light, from row 1 on the sky as in
//            sky/dome.glsl
//   needs    sky/clouds.glsl, sky/dome.glsl; the light, and the dome one row lower
//   units    light without unit, as in lighting/daylight/light
//   source   see sky/clouds.glsl
//   tested   tests/glsl/test_daylight.py, against float64
#include "sky/clouds.glsl"
#include "sky/dome.glsl"
#pragma kernel(output = "daylight:rgba32f")

uniform sampler2D light;   //! input
uniform sampler2D dome;    //! input

vec4 kernel(ivec2 texel) {
    ivec2 last = textureSize(light, 0) - 1;
    if (texel.y == 0) {
        return texel.x > last.x ? vec4(0.0) : texelFetch(light, ivec2(texel.x, 0), 0);
    }
    vec4 cloud = texelFetch(light, ivec2(min(6, last.x), 0), 0);
    float adapted = texelFetch(light, ivec2(min(3, last.x), 0), 0).a;
    ivec2 from = texel - ivec2(0, 1);
    vec3 found = texelFetch(dome, min(from, textureSize(dome, 0) - 1), 0).rgb;
    found *= cloud.a * adapted;
    int rows = max((size.y - 1) / DOMES, 1);
    int table = min(from.y / rows, DOMES - 1);
    float rise = dome_start(vec2(0.0, float(from.y - table * rows) / float(max(rows - 1, 1))),
                            dome_height(table)).x;
    return vec4(found + (texel.x < size.x / 2 ? cloud.rgb * overcast(max(rise, 0.0)) : vec3(0.0)),
                1.0);
}
