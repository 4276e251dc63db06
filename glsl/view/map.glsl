// view/map.glsl -- the terrain from above: any texture as a flat picture, north on top.
//
//   gives    frame, display-encoded
//   needs    colour/encode.glsl, colour/ramp.glsl, maths/number.glsl
//   units    texture values as they are; lowest and highest are in the same
//   source   none: a picture of numbers
//   tested   tests/glsl/test_view.py, against the texture's own values
#include "colour/encode.glsl"
#include "colour/ramp.glsl"
#include "maths/number.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D shown;              //! input("linear", "mipmap")
uniform int channel = 0;              //! menu("colour", "red", "green", "blue", "alpha")
                                      //! What is shown: all channels as a colour, or one as a
                                      //! number
uniform int ramp = 0;                 //! menu("grey", "false colour", "viridis", "cividis",
                                      //! "cool and warm")
                                      //! How a number is shown: colour-blind eyes distinguish
                                      //! all but grey; the last goes away from a middle to
                                      //! both sides
uniform int shrunk = 0;               //! menu("mean", "nearest")
                                      //! How a texture larger than the picture is shown: each
                                      //! pixel the mean of its texels, or one of them
uniform float lowest = 0.0;           //! step(0.01) group("Range") The number shown darkest
uniform float highest = 1.0;          //! step(0.01) group("Range") The number shown brightest
uniform float middle = 0.5;           //! step(0.01) group("Range")
                                      //! The number that "cool and warm" shows grey; both sides
                                      //! have the same scale

vec4 kernel(ivec2 texel) {
    ivec2 shown_size = textureSize(shown, 0);
    // The picture keeps the texture's proportions, in the middle.
    vec2 scale = vec2(shown_size) / vec2(size);
    float worst = max(scale.x, scale.y);
    vec2 place = (vec2(texel) + 0.5 - 0.5 * vec2(size)) * worst + 0.5 * vec2(shown_size);
    if (any(lessThan(place, vec2(0.0))) || any(greaterThanEqual(place, vec2(shown_size)))) {
        return vec4(0.0, 0.0, 0.0, 1.0);
    }
    // Enlarged, texels are squares: numbers are looked at one by one.
    vec4 value = worst > 1.0 && shrunk == 0
               ? textureLod(shown, place / vec2(shown_size), log2(worst))
               : texelFetch(shown, ivec2(place), 0);
    if (any(isnan(value)) || any(isinf(value))) return vec4(NOT_A_NUMBER, 1.0);
    float span = highest - lowest;
    vec4 share = (value - lowest) / (abs(span) < 1e-20 ? 1e-20 : span);
    if (channel == 0) return vec4(srgb_from_linear(share.rgb), 1.0);
    float number = channel == 1 ? share.r : channel == 2 ? share.g : channel == 3 ? share.b
            : share.a;
    if (ramp == 4) {
        float from_middle = lowest + number * span - middle;
        float farthest = max(max(abs(highest - middle), abs(lowest - middle)), 1e-20);
        number = 0.5 + 0.5 * from_middle / farthest;
    }
    return vec4(ramp_colour(ramp, number), 1.0);
}
