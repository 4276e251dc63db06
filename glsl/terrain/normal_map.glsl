// terrain/normal_map.glsl -- normals as colours: x in red, y in green, z in blue.
//
//   gives    colour, linear light; as it is shown, -1..1 of each component is 0..1
//   needs    maths/land.glsl, lighting/sun.glsl; a slope, height per metre
//   units    unit vectors; x east, y north, z up
//   source   the usual code of normal maps; the display's curve is that of IEC 61966-2-1
//   tested   tests/glsl/test_slopes.py, against planes
//
// Level ground is (0.5, 0.5, 1), a light blue: such maps are blue wherever slopes are gentle.
#include "lighting/sun.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f", relief = "shown")

uniform sampler2D slope;  //! input

// anchor: normal
vec3 code_of(vec2 rise) {
    vec3 normal = normalize(vec3(-rise, 1.0));
    return 0.5 + 0.5 * normal;
}
// end: normal

// What the display's curve turns back into the number itself.
vec3 linear_from_shown(vec3 shown) {
    return mix(shown / 12.92, pow((shown + 0.055) / 1.055, vec3(2.4)), step(0.04045, shown));
}

vec4 kernel(ivec2 texel) {
    ivec2 place = ivec2(place_on(textureSize(slope, 0), texel, size) + 0.5);
    return vec4(linear_from_shown(code_of(relief * texelFetch(slope, place, 0).rg)), 1.0);
}
