// scene/cover/tiled.glsl -- the ground's colour, from weights and four tiles.
//
//   gives    coloured: what a white light would show of the ground and of grass on it, linear;
//            layers: the shares of grass, rock, snow and path
//   needs    lighting/sun.glsl, scene/ground_pixel.glsl, scene/surfaces.glsl,
//            texturing/kept_contrast.glsl, texturing/planes.glsl, texturing/splat_weights.glsl,
//            trees/kinds.glsl; seen and ground; weights and four tiles as for view/splat
//   units    metres; colours linear; a tile is so many times side by side from west to east
//   source   Belaiche 2010, section 2.5 (splatting)
//   tested   tests/glsl/test_scene.py, against view/splat
//
// 32 bits, since finer detail is added to it before it is rounded.
#include "lighting/sun.glsl"
#include "scene/ground_pixel.glsl"
#include "scene/surfaces.glsl"
#include "texturing/kept_contrast.glsl"
#include "texturing/planes.glsl"
#include "texturing/splat_weights.glsl"
#include "trees/kinds.glsl"
#pragma kernel(output = "coloured:rgba32f, layers:rgba32f")

uniform sampler2D seen;     //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D weights;  //! input("linear", "mipmap")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap", "white")
#include "view/parameters/layers.glsl"
#include "scene/near/parameters/fine_ground.glsl"
uniform bool triplanar = false;   //! group("Near ground") label("Rock from the sides")
                                  //! The tile of rock is seen from the sides where it is steep

vec3 tiled_rock(vec3 at, GroundPixel pixel);

void kernel(ivec2 texel, out vec4 coloured, out vec4 layers) {
    vec4 at = texelFetch(seen, texel, 0);
    coloured = vec4(0.0);
    layers = vec4(0.0);
    if (!is_top(at.w) && !(is_object(at.w) && is_grass(kind_of(at.w)))) return;
    if (skips_rest()) return;
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    GroundPixel pixel = ground_pixel(ground, at.xyz, ray, eye, extent);
    vec3 one = tiled(grass, at.xy, pixel.foot, grass_repeats, extent);
    vec3 two = tiled_rock(at.xyz, pixel);
    vec3 three = tiled(snow, at.xy, pixel.foot, snow_repeats, extent);
    vec3 four = tiled(path, at.xy, pixel.foot, path_repeats, extent);
    layers = draped(weights, at.xy, pixel.foot, extent);
    layers /= layers.x + layers.y + layers.z + layers.w;
    if (blend == 1) {
        vec4 heights = vec4(one.g / mean_of(grass).g, two.g / mean_of(rock).g,
                            three.g / mean_of(snow).g, four.g / mean_of(path).g);
        layers = weights_by_heights(layers, heights, contrast);
    }
    coloured = vec4(layers.x * one + layers.y * two + layers.z * three + layers.w * four, 1.0);
}

// The tile of rock, of which upright planes show what a plane seen from above draws out.
vec3 tiled_rock(vec3 at, GroundPixel pixel) {
    vec3 above = tiled(rock, at.xy, pixel.foot, rock_repeats, extent);
    if (!fine_ground || !triplanar) return above;
    vec3 shares = planes_of(normal_of_slope(pixel.slope), vec2(30.0, 45.0), 4.0);
    Footprint foot = pixel.foot;
    vec2 rise = vec2(dot(pixel.slope, foot.right), dot(pixel.slope, foot.up));
    Footprint east = Footprint(vec2(foot.right.y, rise.x), vec2(foot.up.y, rise.y));
    Footprint north = Footprint(vec2(foot.right.x, rise.x), vec2(foot.up.x, rise.y));
    // Moved, or all three would show the same piece along the lines where they meet.
    float width = extent.x / rock_repeats;
    vec3 facing_east = tiled(rock, at.yz + vec2(0.37 * width, 0.0), east, rock_repeats, extent);
    vec3 facing_north = tiled(rock, at.xz + vec2(0.71 * width, 0.0), north, rock_repeats, extent);
    return mixed_with_contrast(shares, facing_east, facing_north, above, mean_of(rock));
}
