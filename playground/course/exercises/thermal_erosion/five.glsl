// erosion/thermal/slide.glsl -- what lies steeper than its angle of repose slides down.
//
//   gives    height
//   needs    maths/land.glsl; the height to begin with as `initial`
//   units    heights in units of relief; the input `repose_map` is a factor of the angle, the
//            input `hardness` 1 for rock that falls as fast as the rate says, 2 for half as fast
//   source   Musgrave, Kolb and Mace 1989, "The Synthesis and Rendering of Eroded Fractal
//            Terrains", SIGGRAPH, section 3.3: thermal weathering
//   tested   tests/glsl/test_thermal.py, against float64, cones and the volume
//
// Of two neighbours the lower one gets what the higher one loses, so the volume below the mesh
// stays: a texel on an edge has half a texel's area, one in a corner a quarter. With a rate of 1
// or less no texel becomes higher than its highest neighbour, so nothing oscillates. With four
// neighbours ribs would stay along the axes.
//
// Opposite sides are summed first: a terrain that is turned or mirrored gives the same bits.
#include "maths/land.glsl"
#pragma kernel(output = "height:r32f", repeat = "steps")

uniform sampler2D repose_map;  //! input("white")
uniform sampler2D hardness;    //! input("white")

uniform int steps = 60;        //! slider(0, 2000) Steps on each grid
uniform float repose = 35.0;   //! angle(1, 89) Angle of repose, times the input `repose`
uniform float rate = 1.0;      //! slider(0, 1) step(0.01)
                               //! The share of what is too steep that slides in a step

float at(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    ivec2 there = clamp(texel, ivec2(0), size - 1);
    return texelFetch(field, ivec2(place_on(grid, there, size) + 0.5), 0).r;
}

float tangent(ivec2 texel) {
    float factor = wired_repose_map ? at(repose_map, texel) : 1.0;
    return tan(radians(clamp(repose * factor, 1.0, 89.0)));
}

// The share that slides: of hard rock less, of loose rock no more than is stable.
float quickness(ivec2 texel) {
    return wired_hardness ? 1.0 / max(at(hardness, texel), 1.0) : 1.0;
}

// Along an axis: nothing from past the edge, and half from a texel on the edge to one inside,
// which has twice its area.
vec2 weight(ivec2 there, ivec2 here) {
    ivec2 last = size - 1;
    vec2 within = vec2(equal(clamp(there, ivec2(1), last - 1), there));
    vec2 inside = vec2(equal(clamp(here, ivec2(1), last - 1), here));
    vec2 exists = vec2(equal(clamp(there, ivec2(0), last), there));
    return exists * (1.0 - 0.5 * inside * (1.0 - within));
}

// What comes from the neighbour that way, in metres; below 0, what goes there.
float inflow(ivec2 texel, ivec2 offset, float here) {
    float talus = tangent(texel);
    float share = quickness(texel);
    if (wired_repose_map) talus = 0.5 * (talus + tangent(texel + offset));
    if (wired_hardness) share = min(share, quickness(texel + offset));
    // anchor: rule
    float rise = relief * (previous(texel + offset) - here);
    float maximum = talus * length(vec2(offset) * spacing);
    return share * (rise - clamp(rise, -maximum, maximum));
    // end: rule
}

float kernel(ivec2 texel) {
    ivec2 e = ivec2(1, 0), n = ivec2(0, 1);
    float here = previous(texel);
    vec2 low = weight(texel - 1, texel), high = weight(texel + 1, texel);
    // anchor: eight
    float straight = (low.x * inflow(texel, -e, here) + high.x * inflow(texel, e, here))
                   + (low.y * inflow(texel, -n, here) + high.y * inflow(texel, n, here));
    return here + rate * 0.25 * straight / max(relief, 1e-3);
    // end: eight
}
