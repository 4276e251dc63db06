// view/weights.glsl -- the weights of four layers as colours: one a layer, mixed where layers are.
//
//   gives    colour, linear light, for view/map or over the terrain
//   needs    maths/land.glsl; weights as of texturing/alpha_map
//   units    weights 0..1, colours linear
//   source   none: a picture of numbers. The colours are four of Okabe and Ito 2008, "Color
//            Universal Design", which people with any colour vision tell apart
//   tested   tests/glsl/test_view_weights.py, against the mixture in float64
//
// Where the weights of a texel do not sum to 1, that texel is black or too bright: it is
// neither hidden nor repaired.
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D weights;  //! input("linear", "mipmap")

uniform int shown = 0;  //! menu("mixed", "strongest", "grass", "rock", "snow", "path")
                        //! All four mixed, the one that weighs most, or one alone, white where it
                        //! is all there is
uniform vec3 grass = vec3(0.0, 0.342, 0.171);     //! colour Where the first layer is
uniform vec3 rock = vec3(0.791, 0.347, 0.0);      //! colour Where the second is
uniform vec3 snow = vec3(0.093, 0.456, 0.815);    //! colour Where the third is
uniform vec3 path = vec3(0.604, 0.191, 0.386);    //! colour Where the fourth is

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(weights, 0);
    // The mean of what a texel covers, where the map is finer.
    float level = max(log2(float(grid.x - 1) / float(max(size.x - 1, 1))), 0.0);
    vec4 weight = textureLod(weights, (place_on(grid, texel, size) + 0.5) / vec2(grid), level);
    if (shown >= 2) {
        return vec4(vec3(shown == 2 ? weight.x : shown == 3 ? weight.y : shown == 4 ? weight.z
                         : weight.w), 1.0);
    }
    if (shown == 1) {
        float maximum = max(max(weight.x, weight.y), max(weight.z, weight.w));
        vec3 largest = weight.x == maximum ? grass : weight.y == maximum ? rock
                     : weight.z == maximum ? snow : path;
        return vec4(largest, 1.0);
    }
    return vec4(weight.x * grass + weight.y * rock + weight.z * snow + weight.w * path, 1.0);
}
