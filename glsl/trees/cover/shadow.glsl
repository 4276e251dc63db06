// trees/cover/shadow.glsl -- what trees and another shadow leave of the sun at each pixel.
//
//   gives    shadow, 1 for none; single: how far it is of single trees, 0..1, and not of woods
//   needs    scene/ground_reading.glsl, scene/surfaces.glsl, terrain/heightfield.glsl,
//            trees/kinds.glsl; seen with trees, the ground; the shadows of trees/shade, the sun's
//            visible part with the woods on the terrain (trees/canopy), another shadow, if any
//   units    metres; shares 0..1
//   source   trees/shade.glsl, trees/canopy.glsl
//   tested   tests/glsl/test_trees_light.py: beside a wood, and a shadow of the sketch
//
// Trees have none from trees: how deep in a stand a crown is, is in the light on it (trees/light).
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "terrain/heightfield.glsl"
#include "trees/kinds.glsl"
#pragma kernel(output = "shadow:r16f, single:r32f")

uniform sampler2D seen;     //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D shade;    //! input("black")
uniform sampler2D other_shadow;  //! input("white")
uniform sampler2D canopy_visibility;  //! input("white")
#include "trees/parameters/cell.glsl"
#include "trees/parameters/shade.glsl"

vec2 shade_at(vec2 place);
float shadow_of_woods(vec2 share, float bare);

void kernel(ivec2 texel, out float shadow, out float single) {
    vec4 at = texelFetch(seen, texel, 0);
    shadow = wired_other_shadow ? texelFetch(other_shadow, texel, 0).r : 1.0;
    single = 0.0;
    if (is_object(at.w) ? is_tree(kind_of(at.w)) : !is_top(at.w)) return;
    vec2 shaded = shade_at(at.xy);
    float bare = ground_at(ground, at.xy, extent, 2.0 * cell).sun;
    shadow *= mix(shadow_of_woods(at.xy / extent, bare), 1.0 - shaded.x, shaded.y);
    single = shaded.y;
}

// How much of the sun is taken away here, and 1 in the square where that is known, else 0.
vec2 shade_at(vec2 place) {
    vec2 at = (place - eye.xy) / shade_wide;
    float aside = max(abs(at.x), abs(at.y));
    if (!wired_shade || aside >= 0.5) return vec2(0.0);
    vec2 on = (at + 0.5) * vec2(textureSize(shade, 0)) - 0.5;
    return vec2(height_at(shade, on), 1.0 - smoothstep(0.42, 0.49, aside));
}

// What woods leave of the sun that the bare terrain lets through here. They are opaque there, so
// where single trees throw their shadows these alone are taken.
float shadow_of_woods(vec2 share, float bare) {
    if (!wired_canopy_visibility || bare < 1e-3) return 1.0;
    vec2 last = vec2(textureSize(canopy_visibility, 0) - 1);
    return min(height_at(canopy_visibility, clamp(share, 0.0, 1.0) * last) / bare, 1.0);
}
