// view/splat/surface.glsl -- what the draws of a splatted land share: its mesh, its cut, its light and air.
//
//   gives    in a draw's fragment stage weights_seen, surface_seen
//   needs    maths/drape.glsl, maths/number.glsl, view/surface.glsl; textures come as arguments
//   units    metres; colours linear
//   source   none: as view/land.glsl
//   tested   tests/glsl/test_splat_view.py, against view/land itself
#ifndef VIEW_SPLAT_SURFACE
#define VIEW_SPLAT_SURFACE
#include "maths/drape.glsl"
#include "maths/number.glsl"
#include "view/surface.glsl"

#ifdef FRAGMENT_STAGE
// The four weights of a pixel: those of the level of detail that suits it, brought to a sum of 1
// again, for each level's bytes are rounded by themselves.
vec4 weights_seen(sampler2D weights, vec2 share) {
    vec4 found = texture(weights, drape_uv(share, textureSize(weights, 0)));
    return found / (found.x + found.y + found.z + found.w);
}

// A pixel of the land: its texture in its light; the cut earth where `mark` is above 0; the air before it.
vec3 surface_seen(vec3 shown, sampler2D light, vec2 share, float mark, vec3 earth, vec3 air, float clear) {
    vec3 seen = shown * texture(light, drape_uv(share, textureSize(light, 0)), SHARPER).rgb;
    if (mark > 0.0) seen = cut_of_land(earth, share, mark);
    if (mark < BROKEN || !is_number(seen.r + seen.g + seen.b)) seen = NOT_A_NUMBER;
    return mix(air, seen, clear);
}
#endif
#endif
