// scene/cover/detailed.glsl -- what each pixel shows, in detail finer than the terrain's maps.
//
//   gives    albedo: what a white light would show, linear; bumps: slopes added to the ground's in
//            x and y, their variance in z, and in w the share under a film of water
//   needs    lighting/daylight_date.glsl, maths/number.glsl, scene/ground_pixel.glsl, scene/near/,
//            scene/surface.glsl, scene/surfaces.glsl, trees/kinds.glsl, view/surface.glsl; seen,
//            ground and the ground's colour; the shares of four layers, a wetness, a depth of
//            snow, how exposed the ground is, and other bumps, if there are
//   units    metres; colours linear
//   source   each part in its own file of scene/near/
//   tested   tests/glsl/test_scene.py, tests/glsl/test_objects.py, tests/glsl/test_near.py
//
// Objects have the colour of their kind; tufts of grass that of the ground, and they stand out of
// the snow.
#include "lighting/daylight_date.glsl"
#include "maths/number.glsl"
#include "scene/ground_pixel.glsl"
#include "scene/near/bumps.glsl"
#include "scene/near/cliff.glsl"
#include "scene/near/kinds.glsl"
#include "scene/near/snow.glsl"
#include "scene/near/variation.glsl"
#include "scene/near/wet.glsl"
#include "scene/surface.glsl"
#include "scene/surfaces.glsl"
#include "trees/kinds.glsl"
#include "view/surface.glsl"
#pragma kernel(output = "albedo:rgba16f, bumps:rgba16f")

uniform sampler2D seen;         //! input
uniform sampler2D ground;       //! input("linear", "mipmap")
uniform sampler2D coloured;     //! input
uniform sampler2D layers;       //! input("zero")
uniform sampler2D daylight;     //! input("black")
uniform sampler2D wetness;      //! input("linear", "mipmap", "zero")
uniform sampler2D snow_depth;   //! input("linear", "mipmap", "zero")
uniform sampler2D exposed;      //! input("linear", "mipmap", "zero")
uniform sampler2D other_bumps;  //! input("zero")
#include "view/parameters/earth.glsl"
#include "trees/parameters/season.glsl"
#include "scene/near/parameters/fine_ground.glsl"
#include "scene/near/parameters/near.glsl"

Surface detailed(vec3 at, GroundPixel pixel, vec3 colour, vec4 layer, bool tufts);

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
    albedo.rgb = texelFetch(coloured, texel, 0).rgb;
    if (fine_ground) {
        if (skips_rest()) return;
        PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
        GroundPixel pixel = ground_pixel(ground, at.xyz, ray, eye, extent);
        vec4 layer = wired_layers ? texelFetch(layers, texel, 0) : vec4(0.0);
        Surface surface = detailed(at.xyz, pixel, albedo.rgb, layer, tufts);
        albedo.rgb = surface.albedo;
        bumps += bumps_of(surface, pixel.slope);
    }
    if (tufts) albedo.rgb *= lightness_of_grass(kind_of(at.w));
}

// A number of a map of the terrain.
float map_of(sampler2D map, vec2 place, Footprint foot) {
    return draped(map, place, foot, extent).r;
}

Surface detailed(vec3 at, GroundPixel pixel, vec3 colour, vec4 layer_shares, bool tufts) {
    Footprint foot = pixel.foot;
    vec2 rise = vec2(dot(pixel.slope, foot.right), dot(pixel.slope, foot.up));
    PixelOnGround span = pixel_on_ground(foot.right, foot.up);
    float span_in_space = max(length(vec3(foot.right, rise.x)), length(vec3(foot.up, rise.y)));
    vec2 metres = extent / vec2(max(textureSize(ground, 0) - 1, ivec2(1)));
    float spacing = max(metres.x, metres.y);
    Variation patches = variation_at(at.xy, span.finest);
    Layer layer = Layer(0.0, 0.0, 0.0);
    if (cliffs) {
        float tall = max(abs(rise.x), abs(rise.y));
        layer = strata_at(at.z, thickness * patches.broad, thickness, tall);
    }
    // Tiles have the colours of soil and rock themselves.
    float recoloured = wired_layers ? 0.0 : 1.0;
    vec3 kinds = wired_layers ? kinds_of_layers(layer_shares)
            : kinds_of_ground(length(pixel.slope), rocky, cliffs, strata * layer.tone, stony,
                              patches.dry, map_of(exposed, at.xy, foot));
    float depth = 0.0;
    if (wired_snow_depth && !tufts) depth = max(map_of(snow_depth, at.xy, foot), 0.0);
    // Where there are cliffs, rock has bumps of its own; sand has few.
    vec3 bumpy = vec3((1.0 - 0.8 * sandy) * kinds.xy, cliffs ? 0.0 : kinds.z);
    mat2 grain = grain_of_sand(sandy, ripples_from);
    Bumps bumps = bumps_at(at.xy, grain, bumpy, bumpiness, span, spacing, depth);
    patches.dry = clamp(patches.dry + bumps.dry, -1.0, 1.0);

    Surface surface = Surface(dried(colour, patches, variation), vec3(bumps.slope, 0.0),
                              bumps.variance, 0.0);
    surface.albedo = soiled(surface.albedo, recoloured * soils * kinds.y);
    surface.albedo *= max(1.0 + bumps.tone, 0.1);
    if (cliffs) {
        // Here it is smooth and massive, there it crumbles and shows its layers.
        float broken = smoothstep(-0.5, 0.4, patches.light);
        float rugged = bumpiness * mix(0.4, 1.3, broken);
        float layered = strata * mix(0.3, 1.0, broken);
        Cliff cliff = cliff_at(at, kinds.z, rugged, layered, layer, span_in_space, spacing);
        vec3 bare = mix(surface.albedo, cliff_colour, recoloured * coloured_rock);
        add_cliff(surface, cliff, kinds.z, bare);
    }
    float soaked = wired_wetness ? wet * clamp(map_of(wetness, at.xy, foot), 0.0, 1.0) : 0.0;
    add_water(surface, soaked, bumps, length(pixel.slope));
    add_snow(surface, depth, bumps, patches.dry);
    return surface;
}
