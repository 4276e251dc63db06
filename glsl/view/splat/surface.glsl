// view/splat/surface.glsl -- the surface that draws of a splatted terrain share.
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

// A pixel of the terrain: its texture in its light, or the cut earth, and the air before it.
vec3 surface_seen(vec3 shown, sampler2D light, vec3 position, float mark, vec3 earth, vec3 air,
                  float haze) {
    vec2 share = position.xy / extent;
    vec3 lit = shown * texture(light, drape_uv(share, textureSize(light, 0)), SHARPER).rgb;
    vec3 seen = cut_or(lit, earth, share, mark);
    return through_air(seen, air, haze, distance(eye, position), extent);
}
#endif
#endif
