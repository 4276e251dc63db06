// texturing/height_blend_mix.glsl -- one texture for the whole land from three base images, chosen by height.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl, terrain/heightfield.glsl, texturing/height_weights.glsl; a height
//            0..1, and three images that repeat
//   units    thresholds in grey levels, 0 to 255, as the thesis has them; above 255, never
//   source   Belaiche 2010, sections 2.3.1 to 2.3.3
//   tested   tests/glsl/test_height_blend.py, against the thesis's function in NumPy
//
// The thesis takes texel (i, j) of each image, modulo its size. Here an image repeats so
// many times over the land, whatever the size of either, and is read at the level of
// detail where its texels are as large as this texture's: read at level 0, a fine image
// in a small texture is a few texels picked at random.
//
// rgba16f: linear light in 8 bits leaves 13 steps below the grass's mean.
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#include "texturing/height_weights.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;  //! input
uniform sampler2D grass;   //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;    //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;    //! input("linear", "repeat", "mipmap")

uniform float grass_below = 60.0;  //! slider(0, 300) step(1) group("Heights") Nothing but grass below this grey level
uniform float rock_from = 130.0;   //! slider(0, 300) step(1) group("Heights") No grass from here up
uniform float rock_below = 180.0;  //! slider(0, 300) step(1) group("Heights") No snow below this
uniform float snow_from = 220.0;   //! slider(0, 300) step(1) group("Heights") Nothing but snow from here up
uniform float ragged = 0.0;        //! slider(0, 80) step(1) group("Heights") How far chance moves a height, in grey levels, before it chooses. 0 draws contour lines, as the thesis does
uniform float repeats = 24.0;      //! slider(1, 256) step(1) How often the images stand side by side from west to east
uniform float variety = 0.5;       //! slider(0, 1) step(0.01) How much of each image is read a second time, larger and turned, so that its repeats do not show

// 31 degrees: no whole turns bring it back onto the tiles.
const mat2 TURNED = mat2(0.857, 0.515, -0.515, 0.857);
const float LARGER = 0.29;

// An image's colour at a place counted in tiles, `texels` of this texture to a tile.
vec3 base(sampler2D image, vec2 tile, float texels) {
    float level = log2(float(textureSize(image, 0).x) / texels);
    // A whole level: a blend of two would cost twice the reads and only blur.
    vec3 once = textureLod(image, tile, max(floor(level + 0.5), 0.0)).rgb;
    if (variety <= 0.0) return once;
    vec3 again = textureLod(image, TURNED * tile * LARGER, max(floor(level + log2(LARGER) + 0.5), 0.0)).rgb;
    return mix(once, again, 0.5 * variety);
}

vec4 kernel(ivec2 texel) {
    vec2 place = share_of_texel(texel, size);
    float level = height_at(height, place_on(textureSize(height, 0), texel, size)) * 255.0;
    // Land that is not a number stays visible as such in view/land.
    if (isnan(level)) level = 0.0;
    // Tiles are square on the ground, so a long land has more of them along its length.
    vec2 tile = place * repeats * vec2(1.0, extent.y / extent.x);
    if (ragged > 0.0) level += ragged * gradient_fbm_periodic(tile * 1.7, ivec2(1 << 20), 5, 0.6, 97u);
    vec3 weights = height_weights(level, vec4(grass_below, rock_from, rock_below, snow_from));
    float texels = float(max(size.x - 1, 1)) / repeats;
    vec3 mixed = vec3(0.0);
    if (weights.x > 0.0) mixed += weights.x * base(grass, tile, texels);
    if (weights.y > 0.0) mixed += weights.y * base(rock, tile, texels);
    if (weights.z > 0.0) mixed += weights.z * base(snow, tile, texels);
    return vec4(mixed, 1.0);
}
