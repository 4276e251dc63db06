// texturing/height_blend/ragged.glsl -- heights moved a little, for lines that are no contours.
//
//   gives    height 0..1, and somewhat beyond
//   needs    noise/periodic.glsl, terrain/heightfield.glsl; a height 0..1
//   units    `ragged` in grey levels, 0 to 255, as the thresholds of height_blend/mix
//   source   made here
//   tested   tests/glsl/test_height_blend.py: edges move, what is far from them does not
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D height;      //! input

uniform float ragged = 0.0;    //! slider(0, 80) step(1) group("Heights")
                               //! How far a height moves at random, in grey levels, before it
                               //! chooses. 0 draws contour lines, as the thesis does
uniform float repeats = 24.0;  //! slider(1, 256) step(1)
                               //! How fine the random numbers are: as images that repeat so
                               //! often from west to east

const uint SALT = 0x080b4970u;  // CRC-32 of "texturing/height_blend"

float kernel(ivec2 texel) {
    float level = height_at(height, place_on(textureSize(height, 0), texel, size));
    if (ragged > 0.0) {
        vec2 tile = share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x);
        level += ragged / 255.0 * gradient_fbm_periodic(tile * 1.7, ivec2(1 << 20), 5, 0.6, SALT);
    }
    return level;
}
