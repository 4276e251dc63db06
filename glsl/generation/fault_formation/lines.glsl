// generation/fault_formation/lines.glsl -- random faults, one a texel: its line and height.
//
//   gives    fault: its line in red, green and blue; in alpha its height, in units
//   needs    generation/fault_formation/line.glsl, noise/hash.glsl
//   units    see generation/fault_formation/line.glsl
//   source   Belaiche 2010, section 1.3.6; the linear fall as in Polack 2002, "Focus on 3D
//            Terrain Programming", and the method in Krten 1994, "Generating Realistic
//            Terrain" (Dr. Dobb's Journal, July)
//   tested   tests/glsl/test_marks.py, against a twin in NumPy
//
// A line goes through two random points of the terrain. The thesis's height is random, and falls
// by a factor from fault to fault: here the factor falls from 1 for the first fault towards
// `last`, where the fault after the last would be, in equal steps or in equal ratios.
#include "generation/fault_formation/line.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "fault:rgba32f")

uniform int faults = 200;        //! slider(0, 1000) How many
uniform uint seed = 7u;          //! slider(0, 9999) Which terrain
uniform float amount = 0.05;     //! log_slider(0.001, 1) Height of the first fault, at most
uniform int fall = 0;            //! menu("linear", "ratio") From the first fault to the last: by
                                 //! equal steps, or in equal ratios
uniform float last = 0.1;        //! slider(0.001, 1) step(0.001) What the height falls to, as a
                                 //! share of the first
uniform float variation = 1.0;   //! slider(0, 1) step(0.01) How far heights are random: 0 not at
                                 //! all, 1 from nothing to all

const uint SALT = 0xa3d24078u;  // CRC-32 of "generation/fault_formation"

vec4 kernel(ivec2 texel) {
    uvec3 one = hash3(uvec3(uint(texel.x), 0u, seed + SALT));
    uvec3 two = hash3(uvec3(uint(texel.x), 1u, seed + SALT));
    ivec3 line = fault_line(ivec2(one.xy >> 20u), ivec2(two.xy >> 20u));
    // anchor: fall
    float progress = float(texel.x) / float(max(faults, 1));
    float share = fall == 0 ? 1.0 - (1.0 - last) * progress : pow(last, progress);
    float height = amount * share * (1.0 - variation * unit_from_bits(one.z));
    // end: fall
    // No fault is nothing at all: even one alone gives two heights.
    return vec4(vec3(line), max(floor(height / fault_unit(faults, amount)), 1.0));
}
