// objects/shadow.glsl -- what rocks leave of the sun at each pixel of the ground and the grass.
//
//   gives    shadow, 1 for none: this one's and another's together
//   needs    scene/packing.glsl, scene/surfaces.glsl, terrain/heightfield.glsl, trees/kinds.glsl;
//            seen, the shadows of objects/shade; another shadow, if there is one
//   units    metres; 0..1
//   source   none
//   tested   tests/glsl/test_undergrowth.py
#include "scene/packing.glsl"
#include "scene/surfaces.glsl"
#include "terrain/heightfield.glsl"
#include "trees/kinds.glsl"
#pragma kernel(output = "shadow:r16f")

uniform sampler2D seen;   //! input
uniform sampler2D shade;  //! input
uniform sampler2D other_shadow;  //! input("white")
#include "objects/parameters/shade.glsl"

float kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    float other = wired_other_shadow ? texelFetch(other_shadow, texel, 0).r : 1.0;
    if (!is_top(at.w) && !(is_object(at.w) && is_grass(kind_of(at.w)))) return other;
    vec2 from = (at.xy - eye.xy) / rock_shade_wide;
    float aside = max(abs(from.x), abs(from.y));
    if (aside >= 0.5) return other;
    float taken = height_at(shade, (from + 0.5) * vec2(textureSize(shade, 0)) - 0.5);
    return other * (1.0 - taken * (1.0 - smoothstep(0.42, 0.49, aside)));
}
