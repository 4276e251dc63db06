// generation/fault_formation/sum.comp -- the sum of many faults, row by row.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/fault_formation/line.glsl, maths/whole.glsl
//   units    heights without unit
//   source   made here: differences, and their prefix sum
//   tested   tests/glsl/test_marks.py, against a twin in NumPy
//   agrees   exactly: sums of whole numbers are the same in any order
//
// Each line crosses a row once. A work group has a row. Its readers share the faults: a fault adds
// one number where the row begins and one where the line crosses it. Then the numbers are summed
// along the row, each reader a run of neighbours, twice: first for what the runs before add to
// each, then for the heights. So a terrain costs faults times rows, and its texels, but not faults
// times texels.
#include "generation/fault_formation/line.glsl"
#include "maths/whole.glsl"
#pragma compute(groups = "1, size.y", local = "32, 1", overwrites = "height", agrees = "exact")

uniform sampler2D lines;     //! input
uniform int faults = 200;    //! slider(0, 1000) As in the technique
uniform float amount = 0.05; //! log_slider(0.001, 1) As in the technique

const int READERS = 32;
const int LONGEST = 2112;  // texels of a row that fit; longer rows are done part by part
shared int change[LONGEST];
shared int sums[READERS];

// How many texels of a row lie before its crossing, and whether those after it are raised.
int crossing_of(ivec3 line, int row, out bool after) {
    // Above 0 where the row's first place is raised.
    int value = fault_value(line, ivec2(0, row)) + fault_edge(line);
    int slope = abs(line.x);
    after = line.x > 0;
    if ((value > 0) == after || slope == 0) {
        after = value > 0;
        return 0;
    }
    // value + line.x place changes its side after this many places.
    int far = value > 0 ? value - 1 : -value;
    if (far >= slope * PLACES) return size.x;
    int place = quotient(far, slope);
    // The last texel at or before it: place_of_texel, the other way round.
    int last = max(size.x - 1, 1);
    return min(((((place + 1) * last - (last >> 1) - 1)) >> 15) + 1, size.x);
}

void main() {
    int reader = int(gl_LocalInvocationID.x);
    int y = int(gl_WorkGroupID.y);
    int row = place_of_texel(y, size.y);
    int known = min(faults, textureSize(lines, 0).x);
    float unit = fault_unit(faults, amount);
    for (int start = 0; start < size.x; start += LONGEST) {
        int texels = min(size.x - start, LONGEST);
        int run = (texels + READERS - 1) / READERS;
        for (int x = reader; x < texels; x += READERS) change[x] = 0;
        barrier();
        // anchor: difference
        int first = 0;
        for (int which = reader; which < known; which += READERS) {
            vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
            int height = int(fault.w);
            bool raised;
            int crossing = crossing_of(ivec3(fault.xyz), row, raised) - start;
            if (!raised) height = -height;
            first += crossing > 0 ? -height : height;
            if (crossing > 0 && crossing < texels) atomicAdd(change[crossing], 2 * height);
        }
        if (first != 0) atomicAdd(change[0], first);
        // end: difference
        barrier();
        int from = min(reader * run, texels);
        int to = min(from + run, texels);
        int total = 0;
        for (int x = from; x < to; x++) total += change[x];
        sums[reader] = total;
        barrier();
        int height = 0;
        for (int before = 0; before < reader; before++) height += sums[before];
        for (int x = from; x < to; x++) {
            height += change[x];
            imageStore(out_height, ivec2(start + x, y), vec4(float(height) * unit, 0.0, 0.0, 1.0));
        }
        barrier();
    }
}
