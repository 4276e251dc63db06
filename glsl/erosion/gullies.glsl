// erosion/gullies.glsl -- gullies down every slope, each texel by itself, with no water.
//
//   gives    height; gully: 0 on the ridges between gullies and where there are none, towards 1
//            on the floors of deep ones
//   needs    noise/stripes.glsl, terrain/heightfield.glsl
//   units    heights without unit, in `relief`; inside all is in metres
//   source   the idea: C. John 2018, "Eroded Terrain Noise" (shadertoy.com), and R. Skovbo
//            Johansen 2026 (runevision.com): stripes that run down the slope, octave on octave;
//            the lattice, the fades and the derivatives: made here
//   tested   tests/glsl/test_gullies.py, against the definition in float64 NumPy
//
// In each octave waves of the width w run down the present slope. Of their cosine c and sine s
//
//     z' = z + a (c - 0.3)       slope' = slope - (2 pi a / w) s side
//
// where `side` is the unit vector across the slope and a is how deep the gullies are: the sine is
// the cosine's derivative, so that the next octave, half as wide, runs down into these gullies.
// The depth follows the slope's steepness S,
//
//     a = strength w min(S, 1) fade,     fade = smoothstep(0, 1/2, S) whole
//
// so that flat terrain stays flat. Near ridges and floors of the terrain given the slope turns
// round within a wave's width, and no wave runs either way: `whole` is the share of the slope
// that is the same on both sides. On the crests and floors of each octave, where c is 1 or -1,
// that of the next octaves is less by `clear_crests`.
//
// A function of the place alone, so a part of a terrain, given its corner, is that of the whole.
#include "noise/stripes.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f, gully:r32f")

uniform sampler2D height;            //! input
uniform float width = 1200.0;        //! log_slider(10, 10000) unit("m") Of the widest gullies
uniform float strength = 0.16;       //! slider(0, 0.5) step(0.01) Depth of a gully over its
                                     //! width, on a slope of 45 degrees
uniform int octaves = 5;             //! slider(0, 8) Gullies of so many widths, each half as wide
                                     //! as those before
uniform float gain = 0.5;            //! slider(0, 1) step(0.01) Depth of each octave over the one
                                     //! before
uniform float clear_crests = 0.5;    //! slider(0, 1) step(0.01) How far narrow gullies stay away
                                     //! from the crests and the floors of wide ones
uniform vec2 corner = vec2(0.0);     //! unit("m") parts("east", "north") Where on a larger terrain
                                     //! the south-west corner is
uniform bool tiles = false;          //! checkbox Fits beside its copy, where the height given does
uniform uint seed = 1u;              //! slider(0, 9999) Which gullies

const uint SALT = 0xc6f27da1u;  // CRC-32 of "erosion/gullies"
const float REACH = 0.125;  // of the widest width: how far to each side slopes are measured
const float TAU = 6.2831853;

// The rises from a node to places so far before and after it along an axis, over their distances.
vec2 rises_along(ivec2 node, ivec2 axis, float far, float metres, int last) {
    float here = texelFetch(height, node, 0).r;
    float at = float(node.x * axis.x + node.y * axis.y);
    float before = at - far, after = at + far;
    float end = float(last);
    if (tiles) {
        before += before < 0.0 ? end : 0.0;
        after -= after > end ? end : 0.0;
    }
    before = clamp(before, 0.0, end);
    after = clamp(after, 0.0, end);
    vec2 line = vec2(node * (1 - axis));
    vec2 along = vec2(axis);
    vec2 rise = relief * vec2(here - height_on_line(height, line + before * along, axis),
                              height_on_line(height, line + after * along, axis) - here);
    vec2 run = metres * (tiles ? vec2(far) : vec2(at - before, after - at));
    // At an edge there is one side only.
    if (run.x <= 0.0) return vec2(run.y > 0.0 ? rise.y / run.y : 0.0);
    if (run.y <= 0.0) return vec2(rise.x / run.x);
    return rise / run;
}

// The height of a node, and its slope; by reference how much of the slope is on both sides.
vec3 ground(ivec2 texel, out float whole) {
    vec2 far = max(REACH * width / spacing, vec2(1.0));
    vec2 x = rises_along(texel, ivec2(1, 0), far.x, spacing.x, size.x - 1);
    vec2 y = rises_along(texel, ivec2(0, 1), far.y, spacing.y, size.y - 1);
    vec2 slope = 0.5 * vec2(x.x + x.y, y.x + y.y);
    vec2 bend = 0.5 * vec2(x.y - x.x, y.y - y.x);
    float steep = dot(slope, slope);
    whole = steep / max(steep + dot(bend, bend), 1e-12);
    return vec3(relief * texelFetch(height, texel, 0).r, slope);
}

void kernel(ivec2 texel, out float height, out float gully) {
    float whole;
    vec3 land = ground(texel, whole);
    vec2 slope = land.yz;
    float cut = land.x;
    vec2 place = corner + vec2(texel) * spacing;
    float wide = width;
    float depth = strength * width;
    float floors = 0.0;
    float weight = 1.0;
    float weights = 0.0;
    for (int octave = 0; octave < octaves; octave++) {
        // Waves that texels cannot show fade out from four texels a wave to two.
        float shown = clamp(0.5 * wide / max(spacing.x, spacing.y) - 1.0, 0.0, 1.0);
        if (shown <= 0.0) break;
        float steep = length(slope);
        vec2 side = vec2(-slope.y, slope.x) / max(steep, 1e-6);
        Cells cells = cells_of_width(wide, tiles ? extent : vec2(0.0));
        vec2 wave = stripes(place, side / wide, cells, lattice_seed(seed + SALT, octave));
        float fade = smoothstep(0.0, 0.5, steep) * whole;
        // anchor: octave
        float deep = shown * depth * min(steep, 1.0) * fade;
        cut += deep * (wave.x - 0.3);
        slope -= deep * TAU / wide * wave.y * side;
        // end: octave
        floors += weight * fade * (0.5 - 0.5 * wave.x);
        weights += weight;
        weight *= 0.7;  // of the mask: fine gullies show in it though they are not deep
        whole *= 1.0 - clear_crests * fade * wave.x * wave.x;
        wide *= 0.5;
        depth *= gain;
    }
    height = cut / max(relief, 1e-3);
    gully = smoothstep(0.1, 0.6, floors / max(weights, 1.0));
}
