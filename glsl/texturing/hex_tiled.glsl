// texturing/hex_tiled.glsl -- an image mapped onto the terrain in hexagons, without repeats.
//
//   gives    colour, linear light
//   needs    maths/angle.glsl, maths/land.glsl, texturing/hex_tiling.glsl,
//            texturing/kept_contrast.glsl; an image that repeats
//   units    the image is as large as if it stood `repeats` times side by side from west to east
//   source   see texturing/hex_tiling.glsl and texturing/kept_contrast.glsl
//   tested   tests/glsl/test_texturing_hex.py: the correlation one tile away, mean and contrast
//
// Each hexagon shows another place of the image.
//
// It takes the place of texturing/tiled, for one reading more. Where hexagons meet, two
// or three copies are seen through one another; the sharper, the narrower that border.
#include "maths/angle.glsl"
#include "maths/land.glsl"
#include "texturing/hex_tiling.glsl"
#include "texturing/kept_contrast.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;  //! input("linear", "repeat", "mipmap")

uniform float repeats = 24.0;    //! slider(1, 256) step(1)
                                 //! How often the image would repeat from west to east
uniform float cells = 3.0;       //! slider(1, 8) step(0.1)
                                 //! Hexagons across the width of the image: the more, the smaller
                                 //! the pieces of it
uniform float sharpness = 3.0;   //! slider(1, 16) step(0.1)
                                 //! How narrow the borders are where pieces pass into one another
uniform float turn = 0.0;        //! angle(0, 180)
                                 //! How far each piece is rotated at random. For images that
                                 //! look alike in every direction
uniform uint seed = 1u;          //! slider(0, 9999) Which pieces
uniform float detail = 1.0;      //! slider(0, 1) step(0.01)
                                 //! How much of the image's contrast is left. 0: its mean colour

const uint SALT = 0x74014a9au;  // CRC-32 of "texturing/hex_tiled"

vec3 piece(ivec2 corner, vec2 tile, float level) {
    vec2 shift = random_pair(corner, seed + SALT);
    if (turn > 0.0) {
        // About the corner, so that a piece does not depend on how far it is from the origin.
        vec2 middle = vec2(float(corner.x) + 0.5 * float(corner.y), 0.8660254 * float(corner.y))
                / cells;
        vec2 rotation = cos_sin_degrees(turn * random_signed(corner, seed + SALT + 0x51ed270bu));
        vec2 offset = tile - middle;
        tile = vec2(dot(rotation, offset), rotation.x * offset.y - rotation.y * offset.x);
    }
    return textureLod(colour, tile + shift, level).rgb;
}

vec4 kernel(ivec2 texel) {
    vec2 tile = share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x);
    float texels = float(max(size.x - 1, 1)) / repeats;
    // A whole level, as in texturing/tiled.
    float level = max(floor(log2(float(textureSize(colour, 0).x) / texels) + 0.5), 0.0);
    HexCopies copies = hex_copies(tile, cells);
    vec3 mean = textureLod(colour, vec2(0.5), 99.0).rgb;
    vec3 shown = mixed_with_contrast(
        hex_sharpened(copies.weights, sharpness),
        piece(copies.corner[0], tile, level),
        piece(copies.corner[1], tile, level),
        piece(copies.corner[2], tile, level),
        mean
    );
    return vec4(mix(mean, shown, detail), 1.0);
}
