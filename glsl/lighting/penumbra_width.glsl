// lighting/penumbra_width.glsl -- how wide a shadow's border is, where the sun is partly seen.
//
//   gives    texels, metres: 0 where the sun is seen whole or not at all; share: metres over the
//            widest, for maps
//   needs    maths/land.glsl; the visible part of the sun, 0..1
//   units    texels of the light map, metres on the map, a share without unit
//   source   derived here
//   tested   tests/glsl/test_penumbra_width.py, against the shadow of a wall worked out from its
//            angles
//
// The width is 1/|gradient of V|: how far it is from dark to light at the pace that V has here.
// Along each axis the steeper of the two differences with the neighbours is taken, for at a
// penumbra's rim one neighbour is beyond it and its V no longer falls or rises. A border narrower
// than a texel cannot be distinguished from one of up to two; where V has no slope the width is
// the terrain's own, along its diagonal.
#include "maths/land.glsl"
#pragma kernel(output = "texels:r32f, metres:r32f, share:r32f")

uniform sampler2D visibility;  //! input
uniform float widest = 200.0;  //! log_slider(1, 10000) unit("m") The width whose share is 1

float part_at(ivec2 texel, ivec2 last) {
    return clamp(texelFetch(visibility, clamp(texel, ivec2(0), last), 0).r, 0.0, 1.0);
}

// The steeper of the differences with the neighbours on both sides.
float steeper(float before, float here, float after) {
    float back = here - before;
    float on = after - here;
    return abs(back) > abs(on) ? back : on;
}

void kernel(ivec2 texel, out float texels, out float metres, out float share) {
    ivec2 grid = textureSize(visibility, 0);
    ivec2 last = grid - 1;
    // The widths are where the visibility's own texels are.
    ivec2 spot = ivec2(place_on(grid, texel, size) + 0.5);
    float here = part_at(spot, last);
    vec2 slope = vec2(
        steeper(part_at(spot - ivec2(1, 0), last), here, part_at(spot + ivec2(1, 0), last)),
        steeper(part_at(spot - ivec2(0, 1), last), here, part_at(spot + ivec2(0, 1), last))
    );
    bool partly = here > 0.0 && here < 1.0;
    vec2 farthest = vec2(length(vec2(grid)), length(extent));
    vec2 pace = vec2(length(slope), length(slope / max(spacing_of(grid, extent), 1e-6)));
    vec2 width = partly ? min(1.0 / max(pace, 1e-20), farthest) : vec2(0.0);
    texels = width.x;
    metres = width.y;
    share = metres / widest;
}
