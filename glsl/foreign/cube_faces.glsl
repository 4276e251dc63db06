// foreign/cube_faces.glsl -- six image files as a cube map for a channel of another tool.
//
//   gives    channel_texels, colours encoded as in the files; six faces above each other
//   needs    colour/encode.glsl; six image files, PNG, JPEG or WebP
//   units    none; +X is right, +Y top, +Z front
//   source   made here
//   tested   tests/dialects/test_shadertoy.py, against the files' own colours
//
// A file's upper row is the face's first, as cube maps are stored. Each is stretched over its
// face.
#include "colour/encode.glsl"
#pragma kernel(output = "channel_texels:rgba8")

uniform sampler2D right;   //! file("sketches/data/jacksboro_from_above.jpg", "linear") +X
uniform sampler2D left;    //! file("sketches/data/jacksboro_from_above.jpg", "linear") -X
uniform sampler2D top;     //! file("sketches/data/jacksboro_from_above.jpg", "linear") +Y
uniform sampler2D bottom;  //! file("sketches/data/jacksboro_from_above.jpg", "linear") -Y
uniform sampler2D front;   //! file("sketches/data/jacksboro_from_above.jpg", "linear") +Z
uniform sampler2D back;    //! file("sketches/data/jacksboro_from_above.jpg", "linear") -Z

vec4 kernel(ivec2 texel) {
    int face = texel.y * 6 / size.y;
    vec2 place = (vec2(texel.x, texel.y - face * size.x) + 0.5) / float(size.x);
    place.y = 1.0 - place.y;
    vec4 read = face == 0 ? textureLod(right, place, 0.0)
              : face == 1 ? textureLod(left, place, 0.0)
              : face == 2 ? textureLod(top, place, 0.0)
              : face == 3 ? textureLod(bottom, place, 0.0)
              : face == 4 ? textureLod(front, place, 0.0)
                          : textureLod(back, place, 0.0);
    return vec4(srgb_from_linear(read.rgb), read.a);
}
