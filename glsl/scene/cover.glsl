// scene/cover.glsl -- what each pixel shows of the ground and the objects on it: colour, bumps.
//
//   gives    albedo: what a white light would show, linear; bumps: slopes added to the ground's in
//            x and y, their variance in z, and in w the share under a film of water
//   needs    lighting/daylight_date.glsl, lighting/sun.glsl, maths/number.glsl,
//            scene/footprint.glsl, scene/ground_reading.glsl, scene/near/, scene/surfaces.glsl,
//            texturing/detail_near.glsl, texturing/kept_contrast.glsl, texturing/planes.glsl,
//            texturing/splat_weights.glsl, trees/kinds.glsl, view/surface.glsl; seen and
//            ground; a colour, or weights and four tiles as for view/splat, a wetness, a depth of
//            snow, how exposed the ground is, and other bumps, if there are
//   units    metres; colours linear; a tile is so many times side by side from west to east
//   source   Belaiche 2010, sections 2.5 (splatting) and 2.7 (the detail image)
//   tested   tests/glsl/test_scene.py, against view/terrain and view/splat;
//            tests/glsl/test_objects.py
//
// Any technique of texturing/ gives the colour. What finds a colour in another way, as for trees,
// is a pass of its own that begins with this one's. Objects have the colour of their kind.
// Neither a heightmap nor a colour says anything finer than its texels. Where `fine_ground` is on,
// scene/near/ goes on from there, as fine as a pixel.
#include "lighting/daylight_date.glsl"
#include "maths/number.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/near/bumps.glsl"
#include "scene/near/cliff.glsl"
#include "scene/near/kinds.glsl"
#include "scene/near/snow.glsl"
#include "scene/near/variation.glsl"
#include "scene/near/wet.glsl"
#include "scene/surfaces.glsl"
#include "lighting/sun.glsl"
#include "texturing/kept_contrast.glsl"
#include "texturing/detail_near.glsl"
#include "texturing/planes.glsl"
#include "texturing/splat_weights.glsl"
#include "trees/kinds.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "albedo:rgba16f, bumps:rgba16f")

uniform sampler2D seen;     //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D colour;   //! input("linear", "mipmap", "white")
uniform sampler2D weights;  //! input("linear", "mipmap", "white")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D daylight; //! input("black")
uniform sampler2D wetness;  //! input("linear", "mipmap", "zero")
uniform sampler2D snow_depth;  //! input("linear", "mipmap", "zero")
uniform sampler2D exposed;     //! input("linear", "mipmap", "zero")
uniform sampler2D other_bumps; //! input("zero")
#include "view/parameters/detail_image.glsl"
#include "view/parameters/layers.glsl"
#include "view/parameters/earth.glsl"
#include "trees/parameters/season.glsl"
#include "scene/near/parameters/near.glsl"

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

// The tile of rock, of which upright planes show what a plane seen from above draws out.
vec3 tiled_rock(vec3 at, vec2 slope, Footprint foot) {
    vec3 above = tiled(rock, at.xy, foot, rock_repeats);
    if (!fine_ground || !triplanar) return above;
    vec3 shares = planes_of(normal_of_slope(slope), vec2(30.0, 45.0), 4.0);
    vec2 rise = vec2(dot(slope, foot.right), dot(slope, foot.up));
    Footprint east = Footprint(vec2(foot.right.y, rise.x), vec2(foot.up.y, rise.y));
    Footprint north = Footprint(vec2(foot.right.x, rise.x), vec2(foot.up.x, rise.y));
    // Moved, or all three would show the same piece along the lines where they meet.
    float width = extent.x / rock_repeats;
    vec3 facing_east = tiled(rock, at.yz + vec2(0.37 * width, 0.0), east, rock_repeats);
    vec3 facing_north = tiled(rock, at.xz + vec2(0.71 * width, 0.0), north, rock_repeats);
    return mixed_with_contrast(shares, facing_east, facing_north, above, mean_of(rock));
}

vec3 splatted(vec3 at, vec2 slope, Footprint foot, out vec4 weight) {
    vec3 one = tiled(grass, at.xy, foot, grass_repeats);
    vec3 two = tiled_rock(at, slope, foot);
    vec3 three = tiled(snow, at.xy, foot, snow_repeats);
    vec3 four = tiled(path, at.xy, foot, path_repeats);
    weight = draped(weights, at.xy / extent, foot);
    weight /= weight.x + weight.y + weight.z + weight.w;
    if (blend == 1) {
        vec4 heights = vec4(one.g / mean_of(grass).g, two.g / mean_of(rock).g,
                            three.g / mean_of(snow).g, four.g / mean_of(path).g);
        weight = weights_by_heights(weight, heights, contrast);
    }
    return weight.x * one + weight.y * two + weight.z * three + weight.w * four;
}

vec3 coloured(vec3 at, Footprint foot) {
    vec3 found = draped(colour, at.xy / extent, foot).rgb;
    if (wired_detail_image) {
        vec3 fine = tiled(detail_image, at.xy, foot, detail_repeats);
        float nearness = detail_nearness(distance(eye, at), detail_max_distance);
        found = with_detail(found, fine, mean_of(detail_image), detail_strength * nearness);
    }
    return found;
}

// A number of a map of the terrain.
float map_of(sampler2D map, vec2 place, Footprint foot) {
    return draped(map, place / extent, foot).r;
}

// The ground's colour, finer than it was, and its bumps as this pass gives them. Tufts of grass
// have the ground's colour, and stand out of the snow.
vec4 made_near(vec3 at, vec2 slope, Footprint foot, vec4 weight, bool tufts, inout vec3 found) {
    vec2 rise = vec2(dot(slope, foot.right), dot(slope, foot.up));
    PixelOnGround pixel = pixel_on_ground(foot.right, foot.up);
    float pixel_up = max(length(vec3(foot.right, rise.x)), length(vec3(foot.up, rise.y)));
    vec2 metres = extent / vec2(max(textureSize(ground, 0) - 1, ivec2(1)));
    float spacing = max(metres.x, metres.y);
    Variation patches = variation_at(at.xy, pixel.finest);
    float stands_out = wired_exposed ? map_of(exposed, at.xy, foot) : 0.0;
    Layer layer = Layer(0.0, 0.0, 0.0);
    if (cliffs) {
        float tall = max(abs(rise.x), abs(rise.y));
        layer = strata_at(at.z, thickness * patches.broad, thickness, tall);
    }
    vec3 kinds = kinds_of_layers(weight);
    if (!wired_weights) {
        kinds = kinds_of_ground(length(slope), rocky, cliffs, strata * layer.tone, stony,
                                patches.dry, stands_out);
    }
    float depth = 0.0;
    if (wired_snow_depth && !tufts) depth = max(map_of(snow_depth, at.xy, foot), 0.0);
    // Where there are cliffs, rock has bumps of its own; sand has few.
    vec3 bumpy = vec3((1.0 - 0.8 * sandy) * kinds.xy, cliffs ? 0.0 : kinds.z);
    mat2 grain = grain_of_sand(sandy, ripples_from);
    Bumps bumps = bumps_at(at.xy, grain, bumpy, bumpiness, pixel, spacing, depth);
    vec3 push = vec3(bumps.slope, 0.0);
    float variance = bumps.variance;
    patches.dry = clamp(patches.dry + bumps.dry, -1.0, 1.0);
    found = dried(found, patches, variation);
    if (!wired_weights) found = soiled(found, soils * kinds.y);
    found *= max(1.0 + bumps.tone, 0.1);
    if (cliffs) {
        // Here it is smooth and massive, there it crumbles and shows its layers.
        float broken = smoothstep(-0.5, 0.4, patches.light);
        float rugged = bumpiness * mix(0.4, 1.3, broken);
        float layered = strata * mix(0.3, 1.0, broken);
        Cliff cliff = cliff_at(at, kinds.z, rugged, layered, layer, pixel_up, spacing);
        push += kinds.z * cliff.push;
        variance += kinds.z * kinds.z * cliff.variance;
        vec3 bare = wired_weights ? found : mix(found, cliff_colour, coloured_rock);
        found = mix(found, bare * max(1.0 + cliff.tone * LAYER_HUE, 0.1), kinds.z);
    }
    float film = 0.0;
    if (wired_wetness) {
        float soaked = wet * clamp(map_of(wetness, at.xy, foot), 0.0, 1.0);
        found = mix(found, wet_albedo(found), smoothstep(0.1, 0.6, soaked));
        film = film_of(soaked, bumps.height, bumps.hidden, length(slope));
        push *= 1.0 - film;
        variance *= (1.0 - film) * (1.0 - film);
    }
    if (wired_snow_depth) {
        float snowy = snow_share(depth, bumps.height, bumps.whole, bumps.hidden, patches.dry);
        found = mix(found, SNOW_COLOUR, snowy);
        push = mix(push, vec3(bumps.snowy, 0.0), snowy);
        variance = mix(variance, bumps.snow_variance, snowy);
        film *= 1.0 - snowy;
    }
    // Heights along the normal: only what lies in the ground's plane turns it.
    vec3 normal = normal_of_slope(slope);
    vec3 turned = normal - (push - dot(push, normal) * normal);
    return vec4(-turned.xy / max(turned.z, 0.2 * normal.z) - slope, variance, film);
}

void kernel(ivec2 texel, out vec4 albedo, out vec4 bumps) {
    vec4 at = texelFetch(seen, texel, 0);
    albedo = vec4(0.0);
    bumps = wired_other_bumps ? texelFetch(other_bumps, texel, 0) : vec4(0.0);
    if (is_sky(at.w)) return;
    albedo.a = 1.0;
    if (is_broken(at.w)) {
        albedo.rgb = NOT_A_NUMBER;
        return;
    }
    bool tufts = is_object(at.w) && is_grass(kind_of(at.w));
    if (is_object(at.w) && !tufts) {
        float today = day_of_year(wired_daylight, daylight, day);
        albedo.rgb = colour_of_kind(kind_of(at.w), today);
        return;
    }
    if (is_cut(at.w)) {
        albedo.rgb = cut_of_land(earth, at.xy / extent, depth_of_cut(at.w));
        return;
    }
    if (skips_rest()) return;
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    float far = distance(eye, at.xyz);
    vec2 slope = ground_at(ground, at.xy, extent, far * length(ray.up) / length(ray.ahead)).slope;
    Footprint foot = footprint_of(ray, at.xyz - eye, normalize(vec3(-slope, 1.0)));
    vec4 weight = vec4(1.0, 0.0, 0.0, 0.0);
    vec3 found = wired_weights ? splatted(at.xyz, slope, foot, weight) : coloured(at.xyz, foot);
    if (fine_ground) bumps += made_near(at.xyz, slope, foot, weight, tufts, found);
    albedo.rgb = tufts ? lightness_of_grass(kind_of(at.w)) * found : found;
}
