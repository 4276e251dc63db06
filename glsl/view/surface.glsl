// view/surface.glsl -- what every draw of the terrain shares: its vertices, and its cut.
//
//   gives    place_of_vertex, cut_or, through_air, SHARPER, BROKEN
//   needs    maths/drape.glsl, maths/number.glsl; the texture comes as an argument
//   units    metres; shares 0..1 of the terrain's sides; colours linear
//   source   none: made here
//   tested   tests/glsl/test_view.py and tests/glsl/test_splat_view.py, by the pictures
#ifndef VIEW_SURFACE
#define VIEW_SURFACE
#include "maths/drape.glsl"
#include "maths/number.glsl"

// A level of detail suits the longer side of a pixel's shadow on the terrain, which a flat view
// stretches; so much finer, the shorter side blurs less and nothing flickers yet.
const float SHARPER = -0.7;

// A mark below this is around a vertex whose height is not a number.
const float BROKEN = -10.0;

// The place in x to z of a vertex that is at a share of the terrain, `down` from the terrain
// to the skirt's foot: 0 or 1. In w a mark: that too, or far below BROKEN: far, because samples at
// a triangle's rim are extrapolated.
vec4 place_of_vertex(sampler2D field, vec2 share, float down, vec2 metres, float rise,
                     float skirt) {
    float found = textureLod(field, drape_uv(share, textureSize(field, 0)), 0.0).r;
    bool broken = !is_number(found);
    // A vertex at infinity would take its triangles with it.
    float up = broken ? 0.0 : found * rise;
    // Terrain below height 0 may lie deeper than the foot.
    float foot = min(-skirt * max(metres.x, metres.y), up);
    return vec4(share * metres, mix(up, foot, down), broken ? -1000.0 : down);
}

// The colour of the cut: darker downwards, and darker on its eastern and western walls, so that
// its corners show. `below` is extrapolated far past the foot at a rim.
vec3 cut_of_land(vec3 earth, vec2 share, float below) {
    vec2 inside = min(share, 1.0 - share);
    return earth * (inside.x < inside.y ? 0.7 : 1.0) * mix(1.0, 0.55, min(below, 1.0));
}

// What a pixel shows: its surface, the cut earth where `mark` is above 0, or that it is no number.
vec3 cut_or(vec3 surface, vec3 earth, vec2 share, float mark) {
    vec3 seen = mark > 0.0 ? cut_of_land(earth, share, mark) : surface;
    return mark < BROKEN || !is_number(seen.r + seen.g + seen.b) ? NOT_A_NUMBER : seen;
}

// The same through so many metres of air; over the terrain's width, `haze` of it is e times as
// thin.
vec3 through_air(vec3 seen, vec3 air, float haze, float far, vec2 metres) {
    return mix(air, seen, exp(-haze * far / max(metres.x, metres.y)));
}
#endif
