// scene/cover.glsl -- the colour of what each pixel sees: the ground and the objects on it.
//
//   gives    albedo: what a white light would show, linear
//   needs    lighting/daylight_date.glsl, scene/footprint.glsl, scene/ground_reading.glsl,
//            scene/surfaces.glsl, trees/kinds.glsl, view/surface.glsl, texturing/detail_near.glsl,
//            texturing/splat_weights.glsl; seen and ground; a colour, or weights and four tiles
//            as for view/splat, if there are
//   units    metres; colours linear; a tile is so many times side by side from west to east
//   source   Belaiche 2010, sections 2.5 (splatting) and 2.7 (the detail image)
//   tested   tests/glsl/test_scene.py, against view/terrain and view/splat;
//            tests/glsl/test_objects.py
//
// Any technique of texturing/ gives the colour. What finds a colour in another way, as for trees,
// is a pass of its own that begins with this one's. Objects have the colour of their kind.
#include "lighting/daylight_date.glsl"
#include "maths/number.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "texturing/detail_near.glsl"
#include "texturing/splat_weights.glsl"
#include "trees/kinds.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "albedo:rgba16f")

uniform sampler2D seen;     //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D colour;   //! input("linear", "mipmap", "white")
uniform sampler2D weights;  //! input("linear", "mipmap", "white")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D daylight; //! input("black")
#include "view/parameters/detail_image.glsl"
#include "view/parameters/layers.glsl"
#include "view/parameters/earth.glsl"
#include "trees/parameters/season.glsl"

// A texture that lies over the whole terrain.
vec4 draped(sampler2D image, vec2 share, Footprint foot) {
    ivec2 texels = textureSize(image, 0);
    float level = level_of(foot, vec2(texels - 1) / extent) + SHARPER;
    return textureLod(image, drape_uv(share, texels), level);
}

// A square tile that repeats so often from west to east.
vec3 tiled(sampler2D image, vec2 place, Footprint foot, float repeats) {
    float density = repeats / extent.x;
    return textureLod(image, place * density,
                      level_of(foot, vec2(textureSize(image, 0)) * density) + SHARPER).rgb;
}

// The level after the last is the last: the image's mean.
vec3 mean_of(sampler2D image) {
    return textureLod(image, vec2(0.5), 99.0).rgb;
}

vec3 splatted(vec2 place, Footprint foot) {
    vec3 one = tiled(grass, place, foot, grass_repeats);
    vec3 two = tiled(rock, place, foot, rock_repeats);
    vec3 three = tiled(snow, place, foot, snow_repeats);
    vec3 four = tiled(path, place, foot, path_repeats);
    vec4 weight = draped(weights, place / extent, foot);
    weight /= weight.x + weight.y + weight.z + weight.w;
    if (blend == 1) {
        vec4 heights = vec4(one.g / mean_of(grass).g, two.g / mean_of(rock).g,
                            three.g / mean_of(snow).g, four.g / mean_of(path).g);
        weight = weights_by_heights(weight, heights, contrast);
    }
    return weight.x * one + weight.y * two + weight.z * three + weight.w * four;
}

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (is_sky(at.w)) return vec4(0.0);
    if (is_broken(at.w)) return vec4(NOT_A_NUMBER, 1.0);
    bool tufts = is_object(at.w) && is_grass(kind_of(at.w));
    if (is_object(at.w) && !tufts) {
        float today = day_of_year(wired_daylight, daylight, day);
        return vec4(colour_of_kind(kind_of(at.w), today), 1.0);
    }
    float light = tufts ? lightness_of_grass(kind_of(at.w)) : 1.0;
    vec2 share = at.xy / extent;
    if (is_cut(at.w)) return vec4(cut_of_land(earth, share, depth_of_cut(at.w)), 1.0);
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    float far = distance(eye, at.xyz);
    vec2 slope = ground_at(ground, at.xy, extent, far * length(ray.up) / length(ray.ahead)).slope;
    Footprint foot = footprint_of(ray, at.xyz - eye, normalize(vec3(-slope, 1.0)));
    if (wired_weights) return vec4(light * splatted(at.xy, foot), 1.0);
    vec3 found = draped(colour, share, foot).rgb;
    if (wired_detail_image) {
        vec3 fine = tiled(detail_image, at.xy, foot, detail_repeats);
        float nearness = detail_nearness(far, detail_max_distance);
        found = with_detail(found, fine, mean_of(detail_image), detail_strength * nearness);
    }
    return vec4(light * found, 1.0);
}
