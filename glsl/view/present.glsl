// view/present.glsl -- the last pass: linear light becomes the picture that a screen takes.
//
//   gives    frame, sRGB-encoded, opaque
//   needs    colour/encode.glsl, colour/tone.glsl
//   units    linear light in, encoded 0..1 out; exposure in stops
//   source   see colour/tone.glsl and colour/encode.glsl
//   tested   tests/glsl/test_view.py, against the sRGB curve in Python
#include "colour/encode.glsl"
#include "colour/tone.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D picture;       //! input
uniform float exposure = 0.0;    //! slider(-8, 8) step(0.05) unit("stops") group("Picture")
                                 //! Twice the light for each
uniform int tone = 0;            //! menu("none", "Reinhard", "film") group("Picture")
                                 //! How light above 1 is brought in: cut off, or bent
uniform float white = 3.0;       //! slider(1, 16) step(0.1) group("Picture")
                                 //! Reinhard: the light that becomes white

vec4 kernel(ivec2 texel) {
    vec3 light = max(texelFetch(picture, texel, 0).rgb, 0.0) * exp2(exposure);
    if (tone == 1) light = tone_reinhard(light, white);
    if (tone == 2) light = tone_film(light);
    return vec4(srgb_from_linear(light), 1.0);
}
