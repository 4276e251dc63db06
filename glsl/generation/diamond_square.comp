// generation/diamond_square.comp -- diamond-square, two levels at a time, and normalised.
//
//   gives    height, as generation/diamond_square.toml, for 2^n + 1 texels a side
//   needs    generation/diamond_square/{lattice,rows}.glsl, generation/normalise/stretch.glsl,
//            noise/finest.glsl, terrain/{extremes,order}.glsl
//   units    as the technique
//   source   Belaiche 2010, section 4.3.1; a random number that depends on its point alone
//            lets any part of a level be made by itself
//   tested   tests/glsl/test_diamond_square_variant.py, against the technique's own passes
//   agrees   to the last bit, where the compiler fuses no multiplication with an addition
//
// The first step makes the coarse lattice, of 32 spacings a side or fewer, in one group's
// shared memory. Each further step makes a lattice of four times as many spacings: a thread
// goes north through ROWS rows of the coarser lattice, keeps what the next rows need, and
// writes eight columns of four rows at a time. Neighbouring threads write neighbouring columns.
//
// To normalise, the last step is done twice: first only to find the range, then to write. The
// first skips rows whose heights cannot leave the range that is known from the coarser lattice.
//
// Lattices lie in one buffer, the finest at its beginning, in fours of floats, which a
// processor stores quicker than floats one by one. A row is side + 2 floats long, so that even
// rows begin at a multiple of four and odd rows two after one.
#define random random_at  // the technique has a parameter of that name
#include "generation/diamond_square/rows.glsl"
#undef random
#include "generation/diamond_square/lattice.glsl"
#include "generation/normalise/stretch.glsl"
#include "noise/finest.glsl"
#include "terrain/extremes.glsl"
#include "terrain/order.glsl"
#pragma compute(where = "levels_left = max(log2(size.x - 1) // 2 - 2 - iteration, 0); \
                         spacings = (size.x - 1) // 4**levels_left", \
                groups = "spacings // 256, spacings // 48 + 1", local = "32, 1", \
                repeat = "max(log2(size.x - 1) // 2 - 1, 1) + min(normalise, 1)", \
                buffers = "height:vec4:(size.x + 1)**2 * 9 // 32 + 8; extremes:uint:2", \
                overwrites = "height", agrees = "1e-5")

uniform float smoothing = 0.2;  //! slider(0, 1) step(0.01) As in the technique
uniform uint seed = 7u;         //! slider(0, 9999) As in the technique
uniform int random = 0;         //! menu("centred", "positive") As in the technique
uniform vec4 corners = vec4(0.5, 0.5, 0.5, 0.5);  //! slider(0, 1) step(0.01)
    //! parts("SW", "SE", "NW", "NE") As in the technique
uniform int normalise = 0;      //! menu("none", "max", "minmax") As in the technique

const int LANES = 32;
const int ROWS = 12;            // that a thread goes through
const int MOST_COARSE = 32;     // spacings a side of the coarse lattice
shared float coarse[(MOST_COARSE + 1) * (MOST_COARSE + 1)];

// Halvings from the terrain's side to one texel, and those that the first step makes.
int count_levels() {
    int found = 0;
    while ((1 << found) < size.x - 1) found++;
    return found;
}

int coarse_levels(int levels) {
    return levels <= 5 ? levels : 4 + (levels & 1);
}

// Where in the buffer the lattice of 2^level spacings begins, in fours.
int place_of(int level, int levels) {
    if (level == levels) return 0;
    return ((size.x - 1) * (size.x + 2) >> 2) + 2 + (1 << max(2 * level - 3, 0));
}

Lattice lattice_of(int level) {
    int side = 1 << level;
    float amplitude = 2.0 / float(side) * smoothing;
    return Lattice(side, FINEST_SIDE >> level, amplitude, random == 0, seed + DIAMOND_SQUARE_SALT);
}

// ── the coarse lattice ──

void make_coarse(int lane, int levels) {
    // Loops that do nothing, not an if: a processor goes through the inside of an if anyhow.
    int made = iteration == 0 ? coarse_levels(levels) : -1;
    Lattice lattice = lattice_of(max(made, 0));
    int side = lattice.side;
    int pitch = side + 1;
    for (int i = lane; i < (made < 0 ? 0 : 4); i += LANES) {
        coarse[((i >> 1) * pitch + (i & 1)) * side] = corners[i];
    }
    barrier();
    for (int which = 1; which <= 2 * made; which++) {
        bool centres = (which & 1) == 1;
        int r = half_spacing(which, side);
        lattice.amplitude = float(2 * r) / float(side) * smoothing;
        int cells = centres ? 1 << (which >> 1) : (1 << (which >> 1)) + 1;
        ivec2 along = centres ? ivec2(r, r) : ivec2(r, 0);
        ivec2 across = ivec2(-along.y, along.x);
        for (int y = 0; y < cells; y++) {
            for (int x = lane; x < cells; x += LANES) {
                ivec2 point = texel_of_cell(ivec2(x, y), which, side);
                // Every other row of edges has one cell less.
                if (point.x > side) continue;
                vec4 neighbours;
                bvec4 inside;
                for (int i = 0; i < 4; i++) {
                    ivec2 towards = (i & 1) == 0 ? along : across;
                    ivec2 other = i < 2 ? point + towards : point - towards;
                    inside[i] = min(other.x, other.y) >= 0 && max(other.x, other.y) <= side;
                    neighbours[i] = coarse[inside[i] ? other.y * pitch + other.x : 0];
                }
                coarse[point.y * pitch + point.x] = new_height(neighbours, inside, point, lattice);
            }
        }
        barrier();
    }
    vec2 range = NO_RANGE;
    int texels = made < 0 || normalise == 0 ? 0 : pitch * pitch;
    for (int i = 0; i < texels; i++) range = widened(range, vec2(coarse[i]));
    if (texels > 0 && lane == 0) {
        extremes[0] = key_of_height(range.y);
        extremes[1] = ~key_of_height(range.x);
    }
    int row = levels == 0 ? 2 : side + 2;
    int fours = made < 0 ? 0 : (pitch * row + 3) >> 2;
    for (int i = lane; i < fours; i += LANES) {
        vec4 h;
        for (int k = 0; k < 4; k++) {
            int y = (4 * i + k) / row;
            int x = 4 * i + k - y * row;
            h[k] = coarse[x <= side && y <= side ? y * pitch + x : 0];
        }
        if (made == levels && normalise != 0) {
            h = stretched(h, stretch_of(range, normalise), normalise);
        }
        height[place_of(made, levels) + i] = h;
    }
}

// ── two further levels ──

// Columns 2 j - 1 .. 2 j + 3 of a row; rows beyond the border are those at the border.
void read_five(int place, int side, int row, int j, out float h[5]) {
    int begin = clamp(row, 0, side) * (side + 2) + 2 * j - 1;
    vec4 first = height[place + (begin >> 2)];
    vec4 second = height[place + (begin >> 2) + 1];
    bool early = (begin & 3) == 1;  // else 3: begin is odd
    h[0] = early ? first.y : first.w;
    h[1] = early ? first.z : second.x;
    h[2] = early ? first.w : second.y;
    h[3] = early ? second.x : second.z;
    h[4] = early ? second.y : second.w;
}

// What a step does with the rows it makes.
struct Task {
    int place;      // of the lattice in the buffer
    bool keeps;     // writes them
    bool tells;     // widens the range by them
    bool scales;    // normalises them
    vec2 scale;
};

// Rows 2 k and 2 k + 1 of a lattice, from rows k and k + 1 of the coarser; `below` are the
// centres south of row 2 k, and become those north of it.
void two_rows(Task task, Lattice lattice, int j, int k, bool wanted, float low[6], float high[6],
              inout float below[5], inout vec2 range) {
    int side = lattice.side;
    bool is_last = j == (side >> 3) - 1;
    bool has_odd = 2 * k < side;
    float above[5];
    five_centres(low, high, j, k, lattice, above);
    vec4 even[2], odd[2];
    eight_of_even_row(low, below, above, j, 2 * k, lattice, even);
    eight_of_odd_row(low, high, above, j, 2 * k + 1, lattice, odd);
    // Past the last column of an odd row there is room for one float more.
    if (is_last) odd[1].w = odd[1].z;
    // No eight columns hold the last of an even row, or the first two of an odd one.
    float last = low[4];
    vec4 neighbours = vec4(above[0], high[0], 0.0, low[0]);
    vec2 first = vec2(above[0]);
    first.x = edge_in_column(neighbours, ivec2(0, 2 * k + 1), bvec2(true, false), lattice);
    below = above;
    if (normalise != 0 && wanted && task.tells) {
        if (!has_odd) odd = even;
        vec4 least = min(min(even[0], even[1]), min(odd[0], odd[1]));
        vec4 most = max(max(even[0], even[1]), max(odd[0], odd[1]));
        range.x = min(range.x, min(min(least.x, least.y), min(least.z, least.w)));
        range.y = max(range.y, max(max(most.x, most.y), max(most.z, most.w)));
        if (is_last) range = widened(range, vec2(last));
        vec2 ends = vec2(min(first.x, first.y), max(first.x, first.y));
        if (j == 0 && has_odd) range = widened(range, ends);
    }
    if (normalise != 0 && task.scales) {
        for (int i = 0; i < 2; i++) {
            even[i] = stretched(even[i], task.scale, normalise);
            odd[i] = stretched(odd[i], task.scale, normalise);
        }
        vec4 seam = stretched(vec4(last, last, first), task.scale, normalise);
        last = seam.x;
        first = seam.zw;
    }
    if (!wanted || !task.keeps) return;
    int begin = 2 * k * (side + 2);
    int even_place = task.place + (begin >> 2) + 2 * j;
    int seam_place = task.place + ((begin + side) >> 2);
    height[even_place] = even[0];
    height[even_place + 1] = even[1];
    if (is_last) height[seam_place].x = last;
    if (!has_odd) return;
    height[seam_place + 1 + 2 * j] = odd[0];
    height[seam_place + 2 + 2 * j] = odd[1];
    if (j == 0) {
        height[seam_place].z = first.x;
        height[seam_place].w = first.y;
    }
}

// Narrow the rows from `begin` to `end` to those where heights may leave the range that is
// known: a new height is within `margin` of the heights around it.
void narrow(int place, int side, int j, float margin, bool looks, inout int begin, inout int end) {
    // Others may widen the range meanwhile: it is a true one all the same, and more rows are
    // skipped.
    vec2 known = vec2(height_of_key(~extremes[1]), height_of_key(extremes[0]));
    margin += 1e-5 * max(abs(known.x), abs(known.y));  // roundings
    if (normalise == 1) known.x = -3.4e38;
    vec2 around[4] = vec2[](NO_RANGE, NO_RANGE, NO_RANGE, NO_RANGE);  // of the last four rows
    int first = end;
    int last = begin - 1;
    int stop = looks ? end + 2 : begin - 1;
    for (int row = begin - 1; row < stop; row++) {
        float h[5];
        read_five(place, side, row, j, h);
        // Columns off the lattice hold nothing.
        if (j == 0) h[0] = h[1];
        if (2 * j + 3 > side) h[4] = h[3];
        for (int i = 0; i < 3; i++) around[i] = around[i + 1];
        around[3] = vec2(h[4]);
        for (int i = 0; i < 4; i++) around[3] = widened(around[3], vec2(h[i]));
        vec2 found = widened(widened(around[0], around[1]), widened(around[2], around[3]));
        int q = row - 2;
        if (q >= begin && q < end && (found.x - margin < known.x || found.y + margin > known.y)) {
            first = min(first, q);
            last = q;
        }
    }
    if (looks) {
        begin = first;
        end = last + 1;
    }
}

void make_two_levels(int j, int begin, int levels) {
    int last = max((levels >> 1) - 2, 0);  // the step that makes the terrain, or only looks at it
    int level = min(4 + (levels & 1) + 2 * iteration, levels);
    bool looks = normalise != 0 && iteration == last;
    bool works = iteration > 0 && levels > 5 && j < 1 << max(level - 3, 0);
    Lattice middle = lattice_of(level - 1);
    Lattice fine = lattice_of(level);
    int side = fine.side >> 2;
    int from = place_of(level - 2, levels);
    vec2 known = vec2(height_of_key(~extremes[1]), height_of_key(extremes[0]));
    vec2 scale = stretch_of(known, normalise);
    bool tells = normalise != 0 && (looks || iteration == last - 1);
    Task task = Task(place_of(level, levels), !looks, tells, iteration > last, scale);
    int end = works ? min(begin + ROWS, side + 1) : begin - 1;
    if (!works) j = 0;
    // Twice two displacements lie between the coarser lattice and the finer.
    float margin = 2.0 * (middle.amplitude + fine.amplitude);
    if (normalise != 0) narrow(from, side, j, margin, works && looks, begin, end);

    float low[5], high[5], next[5], below[5];
    float centres[4], next_centres[4];
    float even[6], odd[6], next_even[6];
    read_five(from, side, begin - 1, j, low);
    read_five(from, side, begin, j, high);
    four_centres(low, high, j, begin - 1, middle, centres);
    for (int i = 0; i < 6; i++) even[i] = 0.0;
    for (int i = 0; i < 5; i++) below[i] = 0.0;
    vec2 range = NO_RANGE;
    // The first step only makes what the second needs from the south.
    for (int q = begin - 1; q < end; q++) {
        read_five(from, side, q + 2, j, next);
        six_of_odd_row(low, high, centres, j, 2 * q + 1, middle, odd);
        four_centres(high, next, j, q + 1, middle, next_centres);
        six_of_even_row(high, centres, next_centres, j, 2 * q + 2, middle, next_even);
        two_rows(task, fine, j, 2 * q, q >= begin, even, odd, below, range);
        two_rows(task, fine, j, 2 * q + 1, q >= begin && q < side, odd, next_even, below, range);
        low = high;
        high = next;
        centres = next_centres;
        even = next_even;
    }
    if (normalise != 0 && works && task.tells) {
        atomicMax(extremes[0], key_of_height(range.y));
        atomicMax(extremes[1], ~key_of_height(range.x));
    }
}

void main() {
    int levels = count_levels();
    make_coarse(int(gl_LocalInvocationID.x), levels);
    make_two_levels(int(gl_GlobalInvocationID.x), int(gl_WorkGroupID.y) * ROWS, levels);
}
