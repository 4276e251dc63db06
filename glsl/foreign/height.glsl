// foreign/height.glsl -- another tool's picture as heights: a channel, or its brightness.
//
//   gives    height, as the picture has it
//   needs    colour/luminance.glsl
//   units    height without unit, usually 0..1
//   source   brightness: ITU-R BT.709-6, table 3, item 3.2
//   tested   tests/glsl/test_foreign_terrain.py, against the picture's own numbers
//
// Another tool's picture that a kernel reads keeps 32-bit floats, so that slopes have no steps.
// Where it has another size, each texel takes the nearest one.
#include "colour/luminance.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D picture;  //! input
uniform int channel = 0;    //! menu("red", "green", "blue", "alpha", "brightness")
                            //! What of the picture is the height
uniform float gain = 1.0;   //! slider(-2, 2) step(0.01) The height is multiplied by it
uniform float offset = 0.0; //! slider(-1, 1) step(0.01) And this is added

float kernel(ivec2 texel) {
    ivec2 shown = textureSize(picture, 0);
    vec2 place = (vec2(texel) + 0.5) * vec2(shown) / vec2(size);
    vec4 found = texelFetch(picture, min(ivec2(place), shown - 1), 0);
    float height = channel == 0 ? found.r : channel == 1 ? found.g : channel == 2 ? found.b
                 : channel == 3 ? found.a : luminance(found.rgb);
    return gain * height + offset;
}
