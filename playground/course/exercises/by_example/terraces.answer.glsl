// generation/by_example/blend.glsl -- hexagons of an example, blended with its histogram kept.
//
//   gives    height
//   needs    maths/land.glsl, terrain/heightfield.glsl, texturing/hex_tiling.glsl; the tables of
//            generation/by_example/ranks
//   units    heights as the example's
//   source   Heitz and Neyret 2018, "High-Performance By-Example Noise using a
//            Histogram-Preserving Blending Operator" (Proc. ACM CGIT 1(2)); the normal
//            distribution's integral: Abramowitz and Stegun 1964, 7.1.26
//   tested   tests/glsl/test_by_example.py, by the example's histogram and in float64
//
// Normal numbers of variance 1, weighted and summed, have the variance of the sum of the squares
// of their weights. Divided by its root they have variance 1 again, and are normal where the
// three are independent; the sorted heights bring them back to the example's.
#include "maths/land.glsl"
#include "terrain/heightfield.glsl"
#include "texturing/hex_tiling.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D normal;         //! input
uniform sampler2D sorted;         //! input
uniform sampler2D base;           //! input("zero")
uniform float width = 10240.0;    //! log_slider(10, 100000) unit("m") Of the example on the
                                  //! terrain, from west to east
uniform float cells = 3.0;        //! slider(2, 16) step(0.1) Hexagons across the example: the
                                  //! more, the smaller the pieces of it
uniform float sharpness = 3.0;    //! slider(1, 16) step(0.1) How narrow the borders are where
                                  //! hexagons pass into one another
uniform float amount = 1.0;       //! slider(0, 2) step(0.01) The example's heights are multiplied
                                  //! by it, and added to the base
uniform uint seed = 1u;           //! slider(0, 9999) Which pieces

const uint SALT = 0x4f569c0eu;  // CRC-32 of "generation/by_example/blend"

// The piece of a corner: a hexagon from inside the example, so that none is cut by its edge.
float piece(ivec2 corner, vec2 tile) {
    vec2 point = vec2(corner);
    vec2 middle = vec2(point.x + 0.5 * point.y, 0.8660254 * point.y) / cells;
    vec2 texels = vec2(textureSize(normal, 0) - 1);
    float reach = 1.0 / cells;
    vec2 shape = vec2(1.0, texels.y / texels.x);
    vec2 there = reach + random_pair(corner, seed + SALT) * max(shape - 2.0 * reach, vec2(0.0));
    return height_at(normal, (there + tile - middle) * texels.x);
}

// The share of a normal distribution below a number, off by less than 2e-7.
float normal_share(float x) {
    float z = abs(x) * 0.70710678;
    float t = 1.0 / (1.0 + 0.3275911 * z);
    float p = 1.421413741 + t * (-1.453152027 + t * 1.061405429);
    float tail = 0.5 * exp(-z * z) * t * (0.254829592 + t * (-0.284496736 + t * p));
    return x < 0.0 ? tail : 1.0 - tail;
}

float entry(int k) {
    int columns = textureSize(sorted, 0).x;
    return texelFetch(sorted, ivec2(k % columns, k / columns), 0).r;
}

float kernel(ivec2 texel) {
    vec2 tile = vec2(texel) * spacing / width;
    HexCopies copies = hex_copies(tile, cells);
    vec3 weights = hex_sharpened(copies.weights, sharpness);
    // anchor: blended
    float sum = weights.x * piece(copies.corner[0], tile)
              + weights.y * piece(copies.corner[1], tile)
              + weights.z * piece(copies.corner[2], tile);
    ivec2 sides = textureSize(sorted, 0);
    float place = normal_share(sum / length(weights)) * float(sides.x * sides.y) - 0.5;
    float clamped = clamp(place, 0.0, float(sides.x * sides.y - 1));
    int low = int(clamped);
    float next = entry(min(low + 1, sides.x * sides.y - 1));
    float there = mix(entry(low), next, clamped - float(low));
    // end: blended
    float under = height_at(base, place_on(textureSize(base, 0), texel, size));
    return under + amount * clamped / float(sides.x * sides.y - 1);
}
