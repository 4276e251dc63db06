// generation/fault_formation/sum.glsl -- faults: one side of each line goes up, the other down.
//
//   gives    height, for any terrain; not normalised, half of it below 0
//   needs    generation/fault_formation/line.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.6
//   tested   tests/glsl/test_marks.py, against a twin in NumPy
//
// Fault i goes through the points (x1, y1) and (x2, y2), and moves the terrain by a_i:
//
//     h(x, y) += a_i   where (x2 - x1)(y - y1) - (y2 - y1)(x - x1) > 0, to the left of the line
//     h(x, y) -= a_i   elsewhere
//
// A step is a fault; one run takes as many as are requested. Sums of whole numbers are exact, so
// the order of faults is free: sum.comp and sum.fast.toml next to it take them in other orders.
#include "generation/fault_formation/line.glsl"
#pragma kernel(output = "height:r32f", repeat = "faults", at_once = "faults")

uniform sampler2D lines;     //! input
uniform int faults = 200;    //! slider(0, 1000) How many
uniform float amount = 0.05; //! log_slider(0.001, 1) Height of the first fault, at most

float kernel(ivec2 texel) {
    ivec2 place = ivec2(place_of_texel(texel.x, size.x), place_of_texel(texel.y, size.y));
    int end = min(until, textureSize(lines, 0).x);
    int change = 0;
    // anchor: change
    for (int which = iteration; which < end; which++) {
        vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
        change += is_raised(ivec3(fault.xyz), place) ? int(fault.w) : -int(fault.w);
    }
    // end: change
    float unit = fault_unit(faults, amount);
    // A terrain to begin with is rounded to the same units: so the order of steps stays free.
    return (floor(previous(texel) / unit + 0.5) + float(change)) * unit;
}
