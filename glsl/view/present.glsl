// view/present.glsl -- the last pass: linear light becomes the picture that a screen takes.
//
//   gives    frame, sRGB-encoded, opaque
//   needs    colour/encode.glsl, colour/tone.glsl; what view/exposure and view/bloom give, if any
//   units    linear light in, encoded 0..1 out; exposure in stops
//   source   see colour/tone.glsl and colour/encode.glsl; the vignette is a lens's own, cos^4 of
//            the angle off its axis: 1 / (1 + tan^2)^2
//   tested   tests/glsl/test_view.py, against the sRGB curve in Python; glow, exposure by the
//            picture and vignette in tests/glsl/test_after.py, against float64
//
// In the order of a camera: light spreads in the lens, which darkens corners, then exposure.
#include "colour/encode.glsl"
#include "colour/tone.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D picture;       //! input
uniform sampler2D spread;        //! input("linear", "black")
uniform sampler2D adapted;       //! input("zero")
uniform float exposure = 0.0;    //! slider(-8, 8) step(0.05) unit("stops") group("Picture")
                                 //! Twice the light for each
uniform int tone = 0;            //! menu("none", "Reinhard", "film") group("Picture")
                                 //! How light above 1 is brought in: cut off, or bent
uniform float white = 3.0;       //! slider(1, 16) step(0.1) group("Picture")
                                 //! Reinhard: the light that becomes white
uniform float vignette = 0.0;    //! slider(0, 1) step(0.01) group("Picture")
                                 //! How much darker corners are: the square of the tangent of the
                                 //! lens's angle there
#include "view/parameters/bloom.glsl"

vec4 kernel(ivec2 texel) {
    vec3 light = max(texelFetch(picture, texel, 0).rgb, 0.0);
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    if (wired_spread && bloom > 0.0) light = mix(light, textureLod(spread, place, 0.0).rgb, bloom);
    if (vignette > 0.0) {
        vec2 off = (2.0 * place - 1.0) * vec2(size) / length(vec2(size));
        float falls = 1.0 + vignette * dot(off, off);
        light /= falls * falls;
    }
    light *= exp2(exposure + (wired_adapted ? texelFetch(adapted, ivec2(0), 0).r : 0.0));
    if (tone == 1) light = tone_reinhard(light, white);
    if (tone == 2) light = tone_film(light);
    return vec4(srgb_from_linear(light), 1.0);
}
