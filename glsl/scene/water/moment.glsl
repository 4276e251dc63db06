// scene/water/moment.glsl -- what is the same for all pixels of the water, in one small table.
//
//   gives    moment: rows 0 and 1 the waves of water/wave_table, row 2 the texels below
//   needs    scene/water/moment_texels.glsl, trees/leaves_reading.glsl; waves; a drift, the leaves
//            of trees/leaves and the tiles of scene/cover, if there are
//   units    as of what it copies; colours linear
//   source   none: a copy, since a shader has 16 textures at most in WebGL2 and on macOS
//   tested   tests/glsl/test_scene_water.py
#include "scene/water/moment_texels.glsl"
#include "trees/leaves_reading.glsl"
#pragma kernel(output = "moment:rgba32f")

uniform sampler2D waves;   //! input
uniform sampler2D drift;   //! input("zero")
uniform sampler2D leaves;  //! input("black")
uniform sampler2D grass;   //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D rock;    //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D snow;    //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D path;    //! input("linear", "repeat", "mipmap", "white")

// Oaks and maples, that are neither early nor late.
vec3 wood() {
    return 0.5 * (leaves_in_row(leaves, FIRST_ROCK + OAK, 0.0)
                  + leaves_in_row(leaves, FIRST_ROCK + MAPLE, 0.0));
}

vec4 kernel(ivec2 texel) {
    if (texel.y < 2) return texelFetch(waves, texel, 0);
    if (texel.x == DRIFT.x) return texelFetch(drift, ivec2(0), 0);
    if (texel.x == WOOD.x) return vec4(wired_leaves ? wood() : vec3(0.05, 0.07, 0.03), 1.0);
    // The level after the last is the last: the image's mean.
    if (texel.x == TILES.x) return textureLod(grass, vec2(0.5), 99.0);
    if (texel.x == TILES.x + 1) return textureLod(rock, vec2(0.5), 99.0);
    if (texel.x == TILES.x + 2) return textureLod(snow, vec2(0.5), 99.0);
    return textureLod(path, vec2(0.5), 99.0);
}
