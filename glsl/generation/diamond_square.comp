// generation/diamond_square.comp -- diamond-square, two levels at a time, and normalised.
//
//   gives    height, as generation/diamond_square.toml, for 2^n + 1 texels a side
//   needs    generation/diamond_square/{lattice,rows}.glsl, generation/normalise/stretch.glsl,
//            maths/whole.glsl, noise/finest.glsl, terrain/{extremes,order}.glsl
//   units    as the technique
//   source   Belaiche 2010, section 4.3.1; a random number that depends on its point alone
//            lets any part of a level be made by itself
//   tested   tests/glsl/test_halving.py, against the technique's own passes
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
// Rows are whole eights of floats, stored in fours, which a processor does quicker than one by
// one: so there is a thread more than eights of spacings, whose first column is the last.
#define random random_at  // the technique has a parameter of that name
#include "generation/diamond_square/rows.glsl"
#undef random
#include "generation/diamond_square/lattice.glsl"
#include "generation/normalise/stretch.glsl"
#include "maths/whole.glsl"
#include "noise/finest.glsl"
#include "terrain/extremes.glsl"
#include "terrain/order.glsl"
#pragma compute(stages = "0, 1, 1, 1, 1, 2, 3", local = "32, 1", \
                where = "steps = log2(size.x - 1) // 2 - 2; \
                         needed = min(steps, normalise) if iteration == 5 else \
                                  steps if iteration == 6 else steps - iteration; \
                         spacings = (size.x - 1) // 4**max(steps - iteration, 0); \
                         rows = 4 * (48 if iteration == 5 else 12); \
                         threads = (spacings // 8 + 1) * (spacings // rows + 1); \
                         coarser = (size.x + 3) // 4", \
                groups = "1 if iteration == 0 else \
                          (threads + 31) // 32 if needed > 0 else 0, 1", \
                buffers = "height:vec4:(size.y + 3) * ((size.x + 7) // 8 * 2); \
                           lattices:vec4:coarser**2 + 64; extremes:uint:2", \
                overwrites = "height, lattices", aligned = "32", agrees = "1e-5")

uniform float smoothing = 0.2;  //! slider(0, 1) step(0.01) As in the technique
uniform uint seed = 7u;         //! slider(0, 9999) As in the technique
uniform int random = 0;         //! menu("centred", "positive") As in the technique
uniform vec4 corners = vec4(0.5, 0.5, 0.5, 0.5);  //! slider(0, 1) step(0.01)
    //! parts("SW", "SE", "NW", "NE") As in the technique
uniform int normalise = 0;      //! menu("none", "max", "minmax") As in the technique

const int COARSE = 0, MAKE = 1, LOOK = 2, LAST = 3;
const int LANES = 32;
const int ROWS = 12;            // that a thread goes through
const int ROWS_LOOKED = 48;     // the same where it skips most
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

// Fours from a row of a lattice to the next.
int pitch_of(int side) {
    return ((side + 8) >> 3) << 1;
}

// Where in `lattices` the lattice of 2^level spacings begins, in fours.
int place_of(int level) {
    return 1 << (2 * level - 1);
}

Lattice lattice_of(int level) {
    int side = 1 << level;
    float amplitude = 2.0 / float(side) * smoothing;
    int halvings = findMSB(FINEST_SIDE) - level;
    return Lattice(side, halvings, amplitude, random == 0, seed + DIAMOND_SQUARE_SALT);
}

// ── the coarse lattice ──

void make_coarse(int lane, int levels) {
    int made = coarse_levels(levels);
    Lattice lattice = lattice_of(made);
    int side = lattice.side;
    int pitch = side + 1;
    for (int i = lane; i < 4; i += LANES) {
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
                // Edges are in odd columns of even rows of half spacings, and the other way round.
                ivec2 point = r * (centres ? 2 * ivec2(x, y) + 1 : ivec2(2 * x + 1 - (y & 1), y));
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
    int texels = normalise == 0 ? 0 : pitch * pitch;
    for (int i = 0; i < texels; i++) range = widened(range, vec2(coarse[i]));
    if (texels > 0 && lane == 0) {
        extremes[0] = key_of_height(range.y);
        extremes[1] = ~key_of_height(range.x);
    }
    vec2 scale = stretch_of(range, normalise);
    int row = 4 * pitch_of(side);
    for (int i = lane; i < (row >> 2) * (side + 1); i += LANES) {
        vec4 h;
        for (int k = 0; k < 4; k++) {
            int y = (4 * i + k) / row;
            int x = 4 * i + k - y * row;
            h[k] = coarse[x <= side ? y * pitch + x : 0];
        }
        if (made < levels) lattices[place_of(made) + i] = h;
        else height[i] = stretched(h, scale, normalise);
    }
}

// ── two further levels ──

// Columns 2 j - 1 .. 2 j + 3 of a row; rows beyond the border are those at the border.
void read_five(int place, int side, int row, int j, out float h[5]) {
    int begin = clamp(row, 0, side) * 4 * pitch_of(side) + 2 * j - 1;
    vec4 first = read_lattices(place + (begin >> 2));
    vec4 second = read_lattices(place + (begin >> 2) + 1);
    bool early = (begin & 3) == 1;  // else 3: begin is odd
    h[0] = early ? first.y : first.w;
    h[1] = early ? first.z : second.x;
    h[2] = early ? first.w : second.y;
    h[3] = early ? second.x : second.z;
    h[4] = early ? second.y : second.w;
}

void widen_by_eight(inout vec2 range, vec4 eight[2], bool is_last) {
    // Only the first is one of the lattice's columns.
    if (is_last) eight[0] = eight[1] = vec4(eight[0].x);
    vec4 least = min(eight[0], eight[1]);
    vec4 maximum = max(eight[0], eight[1]);
    range.x = min(range.x, min(min(least.x, least.y), min(least.z, least.w)));
    range.y = max(range.y, max(max(maximum.x, maximum.y), max(maximum.z, maximum.w)));
}

// Write a thread's eight columns of a row: rows past the last lie in room that nobody reads.
void write_eight(int place, vec4 eight[2], vec2 scale) {
    for (int i = 0; i < 2; i++) {
        if (stage == MAKE) lattices[place + i] = eight[i];
        if (stage == LAST) height[place + i] = stretched(eight[i], scale, normalise);
    }
}

// Narrow the rows from `begin` to `end` to those where heights may leave the range that is
// known: a new height is within `margin` of the heights around it.
void narrow(int place, int side, int j, float margin, inout int begin, inout int end) {
    // Others may widen the range meanwhile: it is a true one all the same, and more rows are
    // skipped.
    vec2 known = vec2(height_of_key(~extremes[1]), height_of_key(extremes[0]));
    margin += 1e-5 * max(abs(known.x), abs(known.y));  // roundings
    if (normalise == 1) known.x = -3.4e38;
    vec2 around[4] = vec2[](NO_RANGE, NO_RANGE, NO_RANGE, NO_RANGE);  // of the last four rows
    int first = end;
    int last = begin - 1;
    for (int row = begin - 1; row < end + 2; row++) {
        float h[5];
        read_five(place, side, row, j, h);
        // Columns off the lattice hold nothing.
        if (j == 0) h[0] = h[1];
        if (2 * j + 2 > side) h[2] = h[3] = h[1];
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
    begin = first;
    end = last + 1;
}

void make_two_levels(int job, int levels) {
    int steps = (levels >> 1) - 2;
    int level = stage == MAKE ? 4 + (levels & 1) + 2 * iteration : levels;
    Lattice middle = lattice_of(level - 1);
    Lattice fine = lattice_of(level);
    int side = fine.side >> 2;
    int from = place_of(level - 2);
    int across = (fine.side >> 3) + 1;
    int from_south = quotient(job, across);
    int j = job - from_south * across;
    bool is_last = j == across - 1;
    int rows = stage == LOOK ? ROWS_LOOKED : ROWS;
    int begin = from_south * rows;
    int end = min(begin + rows, side + 1);
    bool tells = normalise != 0 && (stage == LOOK || (stage == MAKE && iteration == steps - 1));
    vec2 known = vec2(height_of_key(~extremes[1]), height_of_key(extremes[0]));
    vec2 scale = stretch_of(known, normalise);
    // Twice two displacements lie between the coarser lattice and the finer.
    float between = 2.0 * (middle.amplitude + fine.amplitude);
    if (stage == LOOK) narrow(from, side, j, between, begin, end);

    float low[5], high[5], next[5], below[5], above[5];
    float centres[4], next_centres[4];
    float even[6], odd[6], next_even[6];
    vec4 eight[2];
    read_five(from, side, begin - 1, j, low);
    read_five(from, side, begin, j, high);
    read_five(from, side, begin + 1, j, next);
    four_centres(low, high, j, begin - 1, middle, next_centres);
    four_centres(high, next, j, begin, middle, centres);
    six_of_odd_row(low, high, next_centres, j, 2 * begin - 1, middle, odd);
    six_of_even_row(high, next_centres, centres, j, 2 * begin, middle, even);
    five_centres(odd, even, j, 2 * begin - 1, fine, below);
    vec2 range = NO_RANGE;
    int pitch = pitch_of(fine.side);
    int place = (stage == MAKE ? place_of(level) : 0) + 4 * begin * pitch + 2 * j;
    for (int q = begin; q < end; q++) {
        low = high;
        high = next;
        read_five(from, side, q + 2, j, next);
        six_of_odd_row(low, high, centres, j, 2 * q + 1, middle, odd);
        four_centres(high, next, j, q + 1, middle, next_centres);
        six_of_even_row(high, centres, next_centres, j, 2 * q + 2, middle, next_even);
        centres = next_centres;
        for (int k = 0; k < 2; k++) {
            int row = 4 * q + 2 * k;
            five_centres(even, odd, j, row >> 1, fine, above);
            eight_of_even_row(even, below, above, j, row, fine, eight);
            if (tells && row <= fine.side) widen_by_eight(range, eight, is_last);
            write_eight(place, eight, scale);
            eight_of_odd_row(even, odd, above, j, row + 1, fine, eight);
            if (tells && row < fine.side) widen_by_eight(range, eight, is_last);
            write_eight(place + pitch, eight, scale);
            below = above;
            even = odd;
            odd = next_even;
            place += 2 * pitch;
        }
    }
    if (tells && begin < end) {
        atomicMax(extremes[0], key_of_height(range.y));
        atomicMax(extremes[1], ~key_of_height(range.x));
    }
}

void main() {
    int levels = count_levels();
    if (stage == COARSE) make_coarse(int(gl_LocalInvocationID.x), levels);
    else make_two_levels(int(gl_GlobalInvocationID.x), levels);
}
