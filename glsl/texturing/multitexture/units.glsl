// texturing/multitexture/units.glsl -- three textures in one pass, each with its coordinates.
//
//   gives    colour, linear light, the shadow map in it
//   needs    maths/angle.glsl, maths/drape.glsl, maths/land.glsl; two images that repeat, and
//            a light for the whole terrain, each of any size
//   units    images repeat so many times from west to east; turns in degrees,
//            counter-clockwise; shifts in images
//   source   Belaiche 2010, section 2.4
//   tested   tests/glsl/test_texturing_multitexture.py, against bilinear sampling in NumPy
//
// As the thesis says of the hardware of its time: textures and coordinates may differ, the
// transparency may not. `share` is one for all the terrain; where it should change with the
// place, take height_blend or splat.
#include "maths/angle.glsl"
#include "maths/drape.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D first;   //! input("linear", "repeat", "mipmap")
uniform sampler2D second;  //! input("linear", "repeat", "mipmap")
uniform sampler2D shadow;  //! input("linear")

uniform int combine = 0;               //! menu("mix", "product", "sum")
                                       //! How the two images become one colour
uniform float share = 0.35;            //! slider(0, 1) step(0.01)
                                       //! How much of the second: of the mixture, or of its effect
uniform float first_repeats = 24.0;    //! slider(1, 256) step(1) group("First")
                                       //! How often it repeats from west to east
uniform float first_turn = 0.0;        //! angle group("First") How far it is turned
uniform vec2 first_shift = vec2(0.0);  //! slider(0, 1) step(0.01) group("First")
                                       //! parts("east", "north")
                                       //! How far it is moved, east and north
uniform float second_repeats = 5.0;    //! slider(1, 256) step(1) group("Second")
                                       //! How often it repeats from west to east
uniform float second_turn = 30.0;      //! angle group("Second") How far it is turned
uniform vec2 second_shift = vec2(0.0); //! slider(0, 1) step(0.01) group("Second")
                                       //! parts("east", "north")
                                       //! How far it is moved, east and north
uniform float shadows = 1.0;           //! slider(0, 1) step(0.01) group("Shadow map")
                                       //! How much of the shadow map is seen

vec3 unit(sampler2D image, vec2 share_of_land, float repeats, float turn, vec2 shift) {
    vec2 rotation = cos_sin_degrees(turn);
    vec2 across = share_of_land * repeats * vec2(1.0, extent.y / extent.x);
    vec2 turned = vec2(dot(rotation, across), rotation.x * across.y - rotation.y * across.x);
    float texels = float(max(size.x - 1, 1)) / repeats;
    float level = max(log2(float(textureSize(image, 0).x) / texels), 0.0);
    return textureLod(image, turned - shift, level).rgb;
}

vec4 kernel(ivec2 texel) {
    vec2 place = share_of_texel(texel, size);
    vec3 one = unit(first, place, first_repeats, first_turn, first_shift);
    vec3 other = unit(second, place, second_repeats, second_turn, second_shift);
    vec3 colour = combine == 0 ? mix(one, other, share)
                : combine == 1 ? one * mix(vec3(1.0), other, share)
                : one + share * other;
    vec3 light = textureLod(shadow, drape_uv(place, textureSize(shadow, 0)), 0.0).rgb;
    return vec4(colour * mix(vec3(1.0), light, shadows), 1.0);
}
