// texturing/splat/means.glsl -- how bright four tiles are in the mean, as one texel.
//
//   gives    means of the green channel, one a tile
//   needs    four colours with their mipmaps
//   units    linear light
//   source   none: a tile's smallest mipmap is its mean
//   tested   tests/glsl/test_splat.py, against the means of the tiles
#pragma kernel(output = "means:rgba32f")

uniform sampler2D grass;  //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;   //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;   //! input("linear", "repeat", "mipmap")
uniform sampler2D path;   //! input("linear", "repeat", "mipmap")

// No tile is so large that its levels are more; asked for a level beyond the last, the last is
// read.
const float SMALLEST = 20.0;

vec4 kernel(ivec2 texel) {
    vec2 middle = vec2(0.5);
    vec4 found = vec4(textureLod(grass, middle, SMALLEST).g, textureLod(rock, middle, SMALLEST).g,
                      textureLod(snow, middle, SMALLEST).g, textureLod(path, middle, SMALLEST).g);
    // A tile that is black has no height anywhere.
    return max(found, vec4(1e-6));
}
