// foreign/image.glsl -- an image file for a channel of another tool, encoded as in the file.
//
//   gives    channel_texels, colour and alpha, encoded for the display
//   needs    colour/encode.glsl; an image file, PNG, JPEG or WebP
//   units    none
//   source   made here
//   tested   tests/glsl/test_foreign.py, against the file's own bytes
//
// Such shaders take colours as the file has them, where texturing/image gives linear light. The
// engine decodes every file; this encodes what it read. The image is stretched over the pass.
#include "colour/encode.glsl"
#pragma kernel(output = "channel_texels:rgba8")

uniform sampler2D image;  //! file("sketches/data/jacksboro_from_above.jpg", "linear", "clamp",
                          //! "mipmap")
                          //! PNG, JPEG or WebP, north on top

vec4 kernel(ivec2 texel) {
    vec2 shrunk = vec2(textureSize(image, 0)) / vec2(size);
    float level = max(log2(max(shrunk.x, shrunk.y)), 0.0);
    vec4 read = textureLod(image, (vec2(texel) + 0.5) / vec2(size), level);
    return vec4(srgb_from_linear(read.rgb), read.a);
}
