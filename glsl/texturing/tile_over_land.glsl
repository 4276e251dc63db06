// texturing/tile_over_land.glsl -- the colour of an image that repeats over the terrain.
//
//   gives    tile_over_land
//   needs    nothing: a pure function, no uniforms; the texture is an argument
//   units    places in images from the south-west corner; texels of the terrain's texture
//   source   Belaiche 2010, section 2.3.3, without the second reading
//   tested   tests/glsl/test_height_blend.py, as texturing/tiled
#ifndef TEXTURING_TILE_OVER_LAND
#define TEXTURING_TILE_OVER_LAND

// 31 degrees: no whole turns bring it back onto the tiles.
const mat2 TURNED = mat2(0.857, 0.515, -0.515, 0.857);
const float LARGER = 0.29;

// `tile` counts images from the south-west corner; `texels` are those of the terrain's texture
// that one image covers.
vec3 tile_over_land(sampler2D image, vec2 tile, float texels, float variety) {
    float level = log2(float(textureSize(image, 0).x) / texels);
    // A whole level: a blend of two would cost twice the reads and only blur.
    vec3 once = textureLod(image, tile, max(floor(level + 0.5), 0.0)).rgb;
    float finer = max(floor(level + log2(LARGER) + 0.5), 0.0);
    vec3 again = textureLod(image, TURNED * tile * LARGER, finer).rgb;
    return mix(once, again, 0.5 * variety);
}
#endif
