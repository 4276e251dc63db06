// view/splat/surface.glsl -- what the draws of a splatted land share: its mesh, its cut, its light and air.
//
//   gives    place_of_vertex; in a draw's fragment stage weights_seen, surface_seen
//   needs    maths/drape.glsl; textures come as arguments
//   units    metres; colours linear
//   source   none: as view/land.glsl
//   tested   tests/glsl/test_splat_view.py, against view/land itself
#ifndef VIEW_SPLAT_SURFACE
#define VIEW_SPLAT_SURFACE
#include "maths/drape.glsl"

// Where height, colour or light is not a number, as in view/map.
const vec3 LAND_NOT_A_NUMBER = vec3(1.0, 0.0, 1.0);

bool is_shown(float value) {
    return !isnan(value) && !isinf(value);
}

// The place in x to z of a vertex that stands at a share of the land, `down` from the land to the
// skirt's foot; in w that too, or far below 0 where the height is not a number.
vec4 place_of_vertex(sampler2D field, vec2 share, float down, vec2 metres, float rise, float skirt) {
    float found = textureLod(field, drape_uv(share, textureSize(field, 0)), 0.0).r;
    bool broken = !is_shown(found);
    float up = broken ? 0.0 : found * rise;
    float foot = min(-skirt * max(metres.x, metres.y), up);
    return vec4(share * metres, mix(up, foot, down), broken ? -1000.0 : down);
}

#ifdef FRAGMENT_STAGE
// The four weights of a pixel: those of the level of detail that suits it, brought to a sum of 1
// again, for each level's bytes are rounded by themselves.
vec4 weights_seen(sampler2D weights, vec2 share) {
    vec4 found = texture(weights, drape_uv(share, textureSize(weights, 0)));
    return found / (found.x + found.y + found.z + found.w);
}

// A pixel of the land: its texture in its light; the cut earth where `mark` is above 0, darker
// downwards and on its eastern and western walls; the air before it.
vec3 surface_seen(vec3 shown, sampler2D light, vec2 share, float mark, vec3 earth, vec3 air, float clear) {
    vec3 seen = shown * texture(light, drape_uv(share, textureSize(light, 0)), -0.7).rgb;
    vec2 inside = min(share, 1.0 - share);
    if (mark > 0.0) seen = earth * (inside.x < inside.y ? 0.7 : 1.0) * mix(1.0, 0.55, min(mark, 1.0));
    if (mark < -10.0 || !is_shown(seen.r + seen.g + seen.b)) seen = LAND_NOT_A_NUMBER;
    return mix(air, seen, clear);
}
#endif
#endif
