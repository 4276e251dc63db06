// scene/cover/draped.glsl -- the ground's colour, from a texture over the whole terrain.
//
//   gives    coloured: what a white light would show of the ground and of grass on it, linear
//   needs    scene/ground_pixel.glsl, scene/surfaces.glsl, texturing/detail_near.glsl,
//            trees/kinds.glsl; seen and ground; a colour and a detail image, if there are
//   units    metres; colours linear
//   source   Belaiche 2010, section 2.7 (the detail image)
//   tested   tests/glsl/test_scene.py, against view/terrain
//
// 32 bits, since finer detail is added to it before it is rounded.
#include "scene/ground_pixel.glsl"
#include "scene/surfaces.glsl"
#include "texturing/detail_near.glsl"
#include "trees/kinds.glsl"
#pragma kernel(output = "coloured:rgba32f")

uniform sampler2D seen;    //! input
uniform sampler2D ground;  //! input("linear", "mipmap")
uniform sampler2D colour;  //! input("linear", "mipmap", "white")
#include "view/parameters/detail_image.glsl"

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (!is_top(at.w) && !(is_object(at.w) && is_grass(kind_of(at.w)))) return vec4(0.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    Footprint foot = ground_pixel(ground, at.xyz, ray, eye, extent).foot;
    vec3 shown = draped(colour, at.xy, foot, extent).rgb;
    if (wired_detail_image) {
        vec3 fine = tiled(detail_image, at.xy, foot, detail_repeats, extent);
        float nearness = detail_nearness(distance(eye, at.xyz), detail_max_distance);
        shown = with_detail(shown, fine, mean_of(detail_image), detail_strength * nearness);
    }
    return vec4(shown, 1.0);
}
