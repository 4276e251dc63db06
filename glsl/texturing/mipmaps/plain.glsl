// texturing/mipmaps/plain.glsl -- a tiled plain to the horizon, filtered by a choice of methods.
//
//   gives    picture, linear light; level: the mip level that the pixel asks for
//   needs    texturing/mipmaps/levels.glsl; a chain of texturing/mipmaps/chain.glsl
//   units    metres; levels from 0, the finest
//   source   the level of OpenGL 3.3, section 3.8.11; several reads along the longer side:
//            EXT_texture_filter_anisotropic
//   tested   tests/glsl/test_mipmaps.py, against the same plain in float64
//
// The eye looks level to the north over a plain; the picture ends at the horizon, its upper edge.
// It is 90 degrees wide, less by `zoom`. The ground that a pixel sees is taken from the rays of
// the pixels to its right and below it: what a draw's dFdx and dFdy give.
#include "texturing/mipmaps/levels.glsl"
#pragma kernel(output = "picture:rgba32f, level:r32f")

uniform sampler2D chain;     //! input
uniform int filtered = 0;    //! menu("one sample", "mip level", "trilinear", "anisotropic",
                             //! "many samples")
                             //! How a pixel finds its colour
uniform int samples = 16;    //! slider(1, 32) The many samples of a pixel, each way
uniform float maximum = 8.0;  //! slider(1, 32) step(1)
                             //! How many samples "anisotropic" takes at most
uniform float eye_height = 2.0;  //! slider(0.5, 20) step(0.1) unit("m") The eye over the plain
uniform float shift = 0.0;   //! slider(0, 10) step(0.01) unit("m") How far the eye has gone north
uniform float zoom = 1.0;    //! slider(1, 16) step(0.5) How many times nearer the plain looks
uniform float tile = 4.0;    //! slider(1, 64) step(0.5) unit("m")
                             //! The width of a tile on the ground
uniform bool cut = false;    //! White where the colour that was found is over 0.6, black elsewhere

// The place on the plain that a place of the picture shows, in tiles; the eye is over (0, shift).
vec2 ground(vec2 pixel) {
    float focal = 0.5 * float(size.x) * zoom;    // pixels
    float down = (float(size.y) - pixel.y) / focal;
    float aside = (pixel.x - 0.5 * float(size.x)) / focal;
    float forward = eye_height / down;
    return vec2(aside * forward, forward + shift) / tile;
}

vec4 shown(vec4 found) {
    return cut ? vec4(vec3(step(0.6, found.r)), 1.0) : found;
}

void kernel(ivec2 texel, out vec4 picture, out float level) {
    vec2 pixel = vec2(texel) + 0.5;
    // anchor: level
    vec2 here = ground(pixel);
    float texels = float(textureSize(chain, 0).y);                    // of a tile
    vec2 right = (ground(pixel + vec2(1.0, 0.0)) - here) * texels;    // dFdx
    vec2 below = (ground(pixel - vec2(0.0, 1.0)) - here) * texels;    // dFdy
    float longer = max(length(right), length(below));
    float shorter = min(length(right), length(below));
    level = log2(longer);
    // end: level
    if (filtered == 0) {
        picture = shown(mip_value(chain, 0, here));
    } else if (filtered == 1) {
        int nearest = int(clamp(floor(level + 0.5), 0.0, log2(texels)));
        picture = shown(mip_value(chain, nearest, here));
    } else if (filtered == 2) {
        picture = shown(mip_blend(chain, level, here));
    } else if (filtered == 3) {
        // anchor: anisotropic
        vec2 along = (length(below) > length(right) ? below : right) / texels;
        float count = clamp(ceil(longer / shorter), 1.0, maximum);
        vec4 sum = vec4(0.0);
        for (float i = 0.5; i < count; i++) {
            sum += mip_blend(chain, log2(longer / count), here + along * (i / count - 0.5));
        }
        picture = shown(sum / count);
        // end: anisotropic
    } else {
        // anchor: samples
        vec4 sum = vec4(0.0);
        for (int y = 0; y < samples; y++) {
            for (int x = 0; x < samples; x++) {
                // No two in one row or column of the pixel, so that thin lines count too.
                vec2 within = (vec2(x, y) + (vec2(y, x) + 0.5) / float(samples)) / float(samples);
                sum += shown(mip_value(chain, 0, ground(vec2(texel) + within)));
            }
        }
        picture = sum / float(samples * samples);
        // end: samples
    }
}
