// view/shaded.glsl -- the terrain, shaded once at each pixel that shows it.
//
//   gives    frame, linear light, over an earlier frame
//   needs    view/ground_texel.glsl, view/surface.glsl, texturing/detail_near.glsl,
//            lighting/daylight_sky.glsl; what view/ground gives; a colour, a light and a detail
//            image if there are
//   units    metres; colours linear
//   source   as view/land.glsl, whose picture it is
//   tested   tests/glsl/test_view_ground.py, against view/land
//
// The second draw of view/land.fast.toml.
#include "lighting/daylight_sky.glsl"
#include "texturing/detail_near.glsl"
#include "view/ground_texel.glsl"
#include "view/surface.glsl"
#pragma draw(mesh = "sheet", output = "frame:rgba16f", over = "ground", samples = 1)

uniform sampler2D ground;  //! input
uniform sampler2D colour;  //! input("linear", "mipmap", "white")
uniform sampler2D light;   //! input("linear", "mipmap", "white")
uniform sampler2D daylight;  //! input("black")
#include "view/parameters/earth.glsl"
#include "view/parameters/detail_image.glsl"
#include "view/parameters/haze.glsl"
uniform int sky = 0;  //! menu("colours", "daylight") group("Sky")
                      //! Whether the haze has that colour, or that of the sky of lighting/daylight

vec4 vertex(vec3 corner, out vec2 pixel, out vec3 ray) {
    pixel = corner.xy * vec2(size);
    ray = ray_through(clip_from_world, corner.xy);
    return vec4(corner.xy * 2.0 - 1.0, 1.0, 1.0);
}

vec4 fragment(vec2 pixel, vec3 ray) {
    Ground seen = ground_of_texel(texelFetch(ground, ivec2(pixel), 0).rg, ray);
    vec2 share = seen.place / extent, moves = seen.change / extent;
    vec3 shown = draped_on_ground(colour, share, moves, SHARPER).rgb;
    if (wired_detail_image) {
        vec2 repeats = detail_repeats * vec2(1.0, extent.y / extent.x);
        vec3 fine = texture_on_ground(detail_image, share * repeats, moves * repeats, SHARPER).rgb;
        vec3 mean = textureLod(detail_image, vec2(0.5), 99.0).rgb;
        float nearness = detail_nearness(seen.eye_distance, detail_max_distance);
        shown = with_detail(shown, fine, mean, detail_strength * nearness);
    }
    shown *= draped_on_ground(light, share, moves, SHARPER).rgb;
    shown = cut_or(shown, earth, share, seen.mark);
    vec3 air = horizon;
    if (sky == 1 && wired_daylight) air = horizon_of(daylight, 0.001 * (base_elevation + eye.z));
    if (haze > 0.0) shown = through_air(shown, air, haze, seen.eye_distance, extent);
    return vec4(shown, 1.0);
}
