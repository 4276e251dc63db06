// erosion/hydraulic/move.glsl -- water takes its load along; the bed is worn and built.
//
//   gives    state: red the bed, green the water on it, blue what the water carries, alpha the
//            mean flow
//   needs    erosion/hydraulic/clock.glsl; state, flux and site of this step
//   units    metres, the load as metres of rock, the flow as metres of water a step
//   source   Mei, Decaudin and Hu 2007, "Fast Hydraulic Erosion Simulation and Visualization on
//            GPU", Pacific Graphics, sections 3.2.2 to 3.5, but that the load goes with the
//            water through the pipes (upwind), for going back along the velocity loses rock;
//            the slump: Musgrave, Kolb and Mace 1989, section 3.3
//   tested   tests/glsl/test_hydraulic.py, against a step in float64, and by what is conserved
//
// What leaves one texel is what another receives, product for product, so water, rock and load
// are conserved to rounding. Opposite sides are summed first, so that a terrain that is turned or
// mirrored is worn alike but for what compilers regroup. By four pipes streams still prefer axes a
// little: on a cone of noise the mean of cos 4a of their directions is 0.17, of all along axes 1.
#include "erosion/hydraulic/clock.glsl"
#pragma kernel(output = "state:rgba32f")

uniform sampler2D state;  //! input
uniform sampler2D flux;   //! input
uniform sampler2D site;   //! input

uniform float evaporation = 0.02;  //! slider(0, 1) step(0.001) unit("1/h")
                                   //! The share of the water that dries
uniform float capacity = 5.0;      //! log_slider(0.1, 100)
                                   //! What a metre of water can carry down a wall [m of rock]
uniform float settling = 0.3;      //! slider(0, 2) step(0.01) unit("1/h")
                                   //! How fast the water drops what it carries too much of
uniform float repose = 36.0;       //! angle(1, 89) Angle of repose: what is steeper slumps
uniform float creep = 1.0;         //! slider(0, 100) step(0.1) unit("m²/h")
                                   //! How fast the soil creeps downhill, which rounds the ground

const float LEAST_SLOPE = 0.01;  // that water carries by, so that plains are not dead
const float SLUMP = 0.25;        // share of what is too steep that slides in a step of an hour
const float MOST_CREEP = 0.1;    // share of a difference, well below the 1/4 that oscillates
const float MEMORY = 50.0;       // [h] over which the flow is averaged
const float FILM = 1e-9;         // [m] of water, below which it counts as dry

vec4 state_at(ivec2 texel) {
    return texelFetch(state, clamp(texel, ivec2(0), size - 1), 0);
}

// The bed of a diagonal neighbour; past an edge, `own`, from which nothing slides.
float bed_across(ivec2 texel, float own) {
    ivec2 there = clamp(texel, ivec2(0), size - 1);
    return there == texel ? texelFetch(state, there, 0).x : own;
}

// Nothing comes from past an edge.
vec4 flux_at(ivec2 texel) {
    vec4 found = texelFetch(flux, clamp(texel, ivec2(0), size - 1), 0);
    return clamp(texel, ivec2(0), size - 1) == texel ? found : vec4(0.0);
}

// What is over the most that lies still, of neighbours so much higher or lower.
vec4 over(vec4 rise, vec4 maximum) {
    return rise - clamp(rise, -maximum, maximum);
}

// 1 - exp(-x), to 0.2 % up to x = 1.2.
float share_in(float x) {
    return x / (1.0 + x * (0.5 + x / 12.0));
}

vec4 kernel(ivec2 texel) {
    ivec2 e = ivec2(1, 0), n = ivec2(0, 1);
    vec4 here = state_at(texel);
    vec4 west = state_at(texel - e), east = state_at(texel + e);
    vec4 south = state_at(texel - n), north = state_at(texel + n);
    vec4 leaves = texelFetch(flux, texel, 0);
    vec4 arrives = vec4(flux_at(texel - e).y, flux_at(texel + e).x,
                        flux_at(texel - n).w, flux_at(texel + n).z);
    float hours = step_hours(size);

    // Water, and the load with it.
    float lost = (leaves.x + leaves.y) + (leaves.z + leaves.w);
    float gained = (arrives.x + arrives.y) + (arrives.z + arrives.w);
    // anchor: load
    float water = max(here.y + (gained - lost), 0.0);
    vec4 brought = arrives * vec4(west.z, east.z, south.z, north.z)
                 / max(vec4(west.y, east.y, south.y, north.y), FILM);
    float load = here.z - lost * (here.z / max(here.y, FILM))
               + ((brought.x + brought.y) + (brought.z + brought.w));
    // end: load

    // Through a metre of width: the mean of inflow and outflow, each the length of a vector. Of a
    // sheet both are its discharge, whatever its angle. A diagonal stream a texel wide comes
    // through one side and leaves through the next: one vector of all four would have 0.71 of the
    // length.
    vec2 wide = 0.5 * spacing / min(spacing.x, spacing.y);
    vec2 inflow = wide * vec2(arrives.x + arrives.y, arrives.z + arrives.w);
    vec2 outflow = wide * vec2(leaves.x + leaves.y, leaves.z + leaves.w);
    float flow = length(inflow) + length(outflow);

    // What it can carry: more, the more water goes through and the steeper its surface. Here the
    // sums of the vectors count, up to 1.41 times their lengths where a sheet flows diagonally:
    // pipes gather water along axes, and by the lengths streams would keep to them (0.40 for the
    // 0.17 above), and a smooth cone would be worn twice as unevenly around.
    float through = (inflow.x + inflow.y) + (outflow.x + outflow.y);
    vec2 fall = (vec2(east.x - west.x, north.x - south.x)
                 + vec2(east.y - west.y, north.y - south.y)) / (2.0 * spacing);
    float squared = dot(fall, fall);
    float can = capacity * through * max(sqrt(squared / (1.0 + squared)), LEAST_SLOPE);

    // Wear or settling. Wear leaves the bed at least half the drop to its lowest neighbour, or
    // single texels become wells. What the bed really loses, after rounding, is what the load
    // gains: rounded apart, a thousand small steps would make rock out of nothing.
    vec2 given = texelFetch(site, texel, 0).rg;
    // anchor: bed
    float settled = min(share_in(settling * hours), 0.5);
    float change = (can > load ? given.g : settled) * (can - load);
    float lowest = min(min(west.x, east.x), min(south.x, north.x));
    float bed = max(here.x - change, min(here.x, 0.5 * (here.x + lowest)));
    load += here.x - bed;
    // end: bed

    // Slump and creep, from the bed as it was, as the neighbours see it. Creep damps waves two
    // texels long, which the slope over two texels does not see. What spreads, as both do, goes
    // as far in an hour on any grid if its share a step grows as the texel shrinks: all of what is
    // too steep slides from 1025 texels on, and finer grids slump more slowly.
    float talus = tan(radians(repose));
    vec4 rises = vec4(west.x, east.x, south.x, north.x) - here.x;
    vec4 across = vec4(bed_across(texel - e - n, here.x), bed_across(texel + e + n, here.x),
                       bed_across(texel + e - n, here.x), bed_across(texel - e + n, here.x))
                - here.x;
    float slides = 0.125 * min(SLUMP / hours, 1.0);
    vec2 creeps = min(creep * hours / (spacing * spacing), MOST_CREEP);
    vec4 straight = slides * over(rises, talus * spacing.xxyy) + creeps.xxyy * rises;
    vec4 diagonal = slides * over(across, vec4(talus * length(spacing)));
    bed += ((straight.x + straight.y) + (straight.z + straight.w))
         + ((diagonal.x + diagonal.y) + (diagonal.z + diagonal.w));

    water = water / (1.0 + evaporation * hours) + given.r;
    return vec4(bed, water, load, mix(here.w, flow, hours / (hours + MEMORY)));
}
