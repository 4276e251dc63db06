// generation/fourier.comp -- the same terrain from half of its spectrum, 32 numbers at a time.
//
//   gives    height
//   needs    generation/fourier/wave.glsl, generation/normalise/stretch.glsl,
//            maths/{complex,fourier,power,whole}.glsl, terrain/order.glsl
//   units    heights without unit: 0..1, unless normalise says otherwise
//   source   Belaiche 2010, section 1.3.3; two real rows as one complex row, as in W. Press and
//            others 1992, "Numerical Recipes in C", section 12.3
//   tested   tests/glsl/test_fourier.py, against scipy.fft and against generation/fourier
//
// The technique draws waves, adds them up to a grid and transforms that: which gives the waves
// again. Here they are weighed as they are drawn, and only the way back to heights is gone.
//
// Rows y, y + n/4, y + n/2 and y + 3n/4 of the terrain are two complex rows, and both lie in one
// row of `waves`, a vec4 a texel. A place along an axis of 2^n has the digits of its number in
// base 32: the top one, one more where n > 10, and a lowest of 1 to 5 bits. Each stage takes
// 32 numbers that differ in one digit, transforms them and puts them back where they were:
//   DRAW      the waves, weighed, and the lowest digit of y; DRAW_AT_2 where the roughness is 2
//   HIGHER    a middle digit, or the top one of x
//   TOP_Y     the top digit of y, and two complex rows from the spectra of four real ones
//   LOW_X     the lowest digit of x; LOW_X_OF_32 where that has all its five bits
// The range of heights is then known, for SHOW. What a digit of frequency has become is a digit
// of place, in reverse order: the top digit of a frequency's place counts single waves.
//
// Backward is forward of the conjugates, so DRAW conjugates, and two rows of four come out
// negated. The real rows need half of the frequencies along x only, for opposite ones are
// conjugates: in columns of four DRAW leaves two frequencies for all rows, of which TOP_Y makes
// these two and their opposites. Frequencies 0 and n/2 are their own opposites and have the
// columns beyond the last instead.
//
// Nearly all of a stage's time is spent to read and to write, on a processor: so a thread takes
// as many numbers as it can hold, and two stages do for an axis of 1024.
//
// Shorter sides than 128 are repeated up to 128; all other frequencies are then 0.
#include "generation/fourier/wave.glsl"
#include "generation/normalise/stretch.glsl"
#include "maths/complex.glsl"
#include "maths/fourier.glsl"
#include "maths/power.glsl"
#include "maths/whole.glsl"
#include "terrain/order.glsl"
#pragma compute(stages = "0, 6, 1, 2, 3, 7, 1, 1, 4, 5", local = "32, 1", \
                accepts = "n up to 8193, m up to 8193", \
                where = "numbers_x = max(size.x - size.x % 2, 128); \
                         numbers_y = max(size.y - size.y % 2, 128); \
                         skipped = (roughness == 2) != iteration if iteration < 2 else \
                             (size.x // 2 == 512) != iteration - 4 if iteration // 2 == 2 else \
                             size.y < 2048 if iteration == 2 else \
                             size.x < 2048 if iteration == 6 else \
                             size.y % 2 == 0 if iteration == 9 else 0; \
                         a_group = 4096", \
                groups = "0 if skipped else (numbers_x + 4) * numbers_y // a_group + 1, 1", \
                buffers = "waves:vec4:(numbers_x + 4) * numbers_y // 4; bounds:uint:2; \
                           height:vec4:(size.x + 3) // 4 * size.y", \
                overwrites = "waves, height", aligned = "16", agrees = "1e-5")

uniform float roughness = 2.0; //! slider(0, 4) step(0.01) As in the technique
uniform uint seed = 7u;        //! slider(0, 9999) As in the technique
uniform int normalise = 2;     //! menu("none", "max", "minmax") As in the technique

const int DRAW = 0, HIGHER = 1, TOP_Y = 2, LOW_X = 3, SHOW = 4, SHOW_LAST_ROW = 5;
const int DRAW_AT_2 = 6, LOW_X_OF_32 = 7;
const int SHOWN = 8;  // jobs of a thread

ivec2 period;  // texels after which the terrain repeats
ivec2 count;   // of the numbers transformed, along each axis
ivec2 bits;    // log2(count)
int rows;      // of `waves`
int pitch;     // from one of its rows to the next
vec4 v[32];

// ── where things lie ──

int lowest_digit(int n) {
    return n < 11 ? n - 5 : n - 10;
}

int frequency_of(int place, int n) {
    int low = max(n - 10, 0);
    int rest = place & ((1 << (n - 5)) - 1);
    return (place >> (n - 5)) + ((rest >> low) << 5) + ((rest & ((1 << low) - 1)) << 10);
}

// The place of the frequency 32 k along x.
int place_of_multiple(int k) {
    int low = max(bits.x - 10, 0);
    return ((k & 31) << low) | (k >> 5);
}

// The four columns of a pair of frequencies along x, and those frequencies. The pairs are
// half the spectrum: neighbours among the places whose top digit is 1 to 15, or 16 in its lower
// half, whose opposites lie mirrored in those of 31 to 16; then those whose top digit is 0.
ivec4 columns_of(int pair, out ivec2 frequencies) {
    int n = bits.x;
    int simple = 31 * (count.x >> 7);
    if (pair < simple) {
        int place = (count.x >> 5) + 2 * pair;
        int below = (1 << (n - 5)) - 1;
        int opposite = ((32 - (place >> (n - 5))) << (n - 5)) | (below - (place & below));
        frequencies = ivec2(frequency_of(place, n), frequency_of(place + 1, n));
        return ivec4(place, opposite, place + 1, opposite - 1);
    }
    int k = 2 * (pair - simple);
    int all_k = count.x >> 5;
    frequencies = 32 * ivec2(k, k + 1);
    ivec4 found = ivec4(place_of_multiple(k), place_of_multiple((all_k - k) & (all_k - 1)),
                        place_of_multiple(k + 1), place_of_multiple(all_k - k - 1));
    if (k == 0) found.y = count.x;
    if (2 * k == all_k) found.yzw = count.x + ivec3(1, 2, 3);
    return found;
}

// The 32 numbers of one digit, whose lowest bit is bit p of the place.
struct Digit {
    int base;           // of the first, in `waves`
    int apart;          // from one to the next
    int place;          // of the first
    int low;            // the digits below
    ivec2 frequencies;  // of the two columns along x, for numbers along y
};

Digit along_x(int job, int p) {
    Digit digit;
    int mine = job & ((count.x >> 5) - 1);
    digit.low = mine & ((1 << p) - 1);
    digit.place = ((mine >> p) << (p + 5)) | digit.low;
    digit.base = (job >> (bits.x - 5)) * pitch + digit.place;
    digit.apart = 1 << p;
    digit.frequencies = ivec2(0);
    return digit;
}

// The top two bits of a place along y are the column of four. Threads in twos differ in the
// topmost, so that neighbours store in columns side by side: a processor stores whole lines.
Digit along_y(int job, int p) {
    Digit digit;
    int pairs = (count.x >> 2) + 1;
    int rest = quotient(job >> 1, pairs);
    int mine = rest | ((job & 1) << (bits.y - 6));
    ivec4 columns = columns_of((job >> 1) - rest * pairs, digit.frequencies);
    digit.low = mine & ((1 << p) - 1);
    digit.place = ((mine >> p) << (p + 5)) | digit.low;
    int quarter = digit.place >> (bits.y - 2);
    ivec2 half_of_them = quarter < 2 ? columns.xy : columns.zw;
    int column = (quarter & 1) == 0 ? half_of_them.x : half_of_them.y;
    digit.base = (digit.place & (rows - 1)) * pitch + column;
    digit.apart = pitch << p;
    return digit;
}

// ── the stages ──

vec2 near_roots[4], far_roots[8];

// For root(e) = exp(-2 pi i e low / 2^(p + 5)): a product of two, so that no error grows.
void find_roots(int low, int p) {
    near_roots[0] = far_roots[0] = vec2(1.0, 0.0);
    for (int k = 1; k < 4; k++) near_roots[k] = conjugate(root_of_one(k * low, 32 << p));
    for (int k = 1; k < 8; k++) far_roots[k] = conjugate(root_of_one(4 * k * low, 32 << p));
}

vec2 root(int e) {
    return complex_product(near_roots[e & 3], far_roots[e >> 2]);
}

void higher(Digit digit, int p) {
    find_roots(digit.low, p);
    for (int e = 0; e < 32; e++) {
        v[e] = both_products(read_waves(digit.base + e * digit.apart), root(e));
    }
    transform32(v);
    for (int e = 0; e < 32; e++) waves[digit.base + e * digit.apart] = v[place32(e)];
}

void low_x(Digit digit) {
    for (int e = 0; e < 32; e++) v[e] = read_waves(digit.base + e);
    if (stage == LOW_X_OF_32) {
        transform32(v);
        for (int e = 0; e < 32; e++) waves[digit.base + e] = v[place32(e)];
        return;
    }
    int levels = lowest_digit(bits.x);
    transform_blocks(v, levels);
    int block = ~((1 << levels) - 1);
    for (int e = 0; e < 32; e++) {
        waves[digit.base + ((e & block) | block_number(e, levels))] = v[e];
    }
}

void top_y(int job) {
    int pairs = (count.x >> 2) + 1;
    int p = bits.y - 5;
    int low = quotient(job, pairs);
    ivec2 unused;
    ivec4 columns = columns_of(job - low * pairs, unused);
    find_roots(low, p);
    for (int e = 0; e < 32; e++) {
        int row = ((e & 7) << p) | low;
        v[e] = both_products(read_waves(row * pitch + columns[e >> 3]), root(e));
    }
    transform32(v);
    // Conjugates: of Z[k] = R[k] + i S[k] and of Z[-k] = conj R[k] + i conj S[k].
    for (int i = 0; i < 8; i++) {
        int base = ((i << p) | low) * pitch;
        vec4 a = v[place32(i)];
        vec4 b = v[place32(i + 8)];
        vec4 c = v[place32(i + 16)];
        vec4 d = v[place32(i + 24)];
        waves[base + columns.x] = vec4(a.x + b.y, a.y - b.x, c.x + d.y, c.y - d.x);
        waves[base + columns.y] = vec4(a.x - b.y, -a.y - b.x, c.x - d.y, -c.y - d.x);
        waves[base + columns.z] = vec4(a.z + b.w, a.w - b.z, c.z + d.w, c.w - d.z);
        waves[base + columns.w] = vec4(a.z - b.w, -a.w - b.z, c.z - d.w, -c.w - d.z);
    }
}

// One axis of a wave: its frequency and the opposite one, signed, as generation/fourier/wave.glsl
// has them.
struct Part {
    int waves, opposite;
    bool ends;      // where a short side that is repeated ends; of others all waves are 0
    float squared;  // of the frequency, along the terrain's longer side
};

Part part_of(int frequency, int count, int period) {
    Part part;
    int along = frequency - (2 * frequency > count ? count : 0);
    int copies = findMSB(count) - findMSB(period);  // a power of two
    part.waves = along >> copies;
    part.ends = part.waves << copies == along;
    part.opposite = (2 * part.waves == period ? period : 0) - part.waves;
    float f = float(part.waves) * (float(max(size.x, size.y) & ~1) / float(period));
    part.squared = f * f;
    return part;
}

// A wave as the filter leaves it, conjugate, with what the way back multiplies by taken out:
// wave_number, whose questions about x are asked once for all waves of a column.
vec2 weighed(Part x, Part y) {
    bool is_drawn = x.waves == x.opposite ? y.waves >= y.opposite : x.waves > x.opposite;
    ivec2 key = ivec2(max(x.waves, x.opposite), is_drawn ? y.waves : y.opposite);
    vec2 pair = random_pair(key, seed + FOURIER_SALT) * 2.0 - 1.0;
    vec2 wave = 0.70710678 * vec2(pair.x, is_drawn ? -pair.y : pair.y);
    if (x.waves == x.opposite && y.waves == y.opposite) wave = vec2(pair.x, 0.0);
    float squared = x.squared + y.squared;
    float weight = stage == DRAW_AT_2 ? 1.0 / squared : power(squared, -0.5 * roughness);
    if (squared == 0.0) weight = 1.0;
    weight *= inversesqrt(float(period.x) * float(period.y));
    return x.ends && y.ends ? wave * weight : vec2(0.0);
}

void draw(Digit digit) {
    int levels = lowest_digit(bits.y);
    int block = ~((1 << levels) - 1);
    Part one = part_of(digit.frequencies.x, count.x, period.x);
    Part other = part_of(digit.frequencies.y, count.x, period.x);
    for (int e = 0; e < 32; e++) {
        int l = frequency_of(digit.place | (e & block) | block_number(e, levels), bits.y);
        Part y = part_of(l, count.y, period.y);
        v[e] = vec4(weighed(one, y), weighed(other, y));
    }
    transform_blocks_back(v, levels);
    for (int e = 0; e < 32; e++) waves[digit.base + e * digit.apart] = v[e];
}

// ── heights ──

// `bounds` are the greatest key, and the greatest complement of one: zeros are less than any.
void measure() {
    vec4 minimum = v[0];
    vec4 maximum = v[0];
    for (int e = 1; e < 32; e++) {
        minimum = min(minimum, v[e]);
        maximum = max(maximum, v[e]);
    }
    uint lowest = ~key_of_height(min(min(minimum.x, minimum.z), -max(maximum.y, maximum.w)));
    uint highest = key_of_height(max(max(maximum.x, maximum.z), -min(minimum.y, minimum.w)));
    // Most threads have nothing to change, and see that sooner than an atomic tells them.
    if (lowest > bounds[0]) atomicMax(bounds[0], lowest);
    if (highest > bounds[1]) atomicMax(bounds[1], highest);
}

// Fours of heights in each of four rows, a quarter of the count apart: one such job of `many`
// rows, where row 0 of `waves` is the terrain's row `first`.
void show(int job, int first, int many, vec2 stretch) {
    int fours = (size.x + 3) >> 2;
    int row = quotient(job, fours);
    int place = job - row * fours;
    if (row >= many) return;
    vec4 found[4];
    for (int j = 0; j < 4; j++) {
        int x = (4 * place + j) & (count.x - 1);
        found[j] = read_waves(row * pitch + x) * vec4(1.0, -1.0, 1.0, -1.0);
    }
    for (int g = 0; g < 4; g++) {
        int y = first + row + g * rows;
        vec4 four = vec4(found[0][g], found[1][g], found[2][g], found[3][g]);
        if (y < size.y) height[y * fours + place] = stretched(four, stretch, normalise);
    }
}

void main() {
    period = size - (size & 1);
    count = max(period, ivec2(128));
    bits = ivec2(findMSB(count.x), findMSB(count.y));
    rows = count.y >> 2;
    pitch = count.x + 4;

    int job = int(gl_GlobalInvocationID.x);
    bool x_axis = iteration > 3;
    bool top = iteration == 7;
    int n = x_axis ? bits.x : bits.y;
    int p = top ? n - 5 : n - 10;
    int jobs = x_axis ? count.x * rows >> 5 : ((count.x >> 2) + 1) * (count.y >> 5);
    if (job >= jobs && stage != SHOW && stage != SHOW_LAST_ROW) return;

    if (stage == DRAW || stage == DRAW_AT_2) draw(along_y(job, 0));
    if (stage == TOP_Y) top_y(job);
    if (stage == LOW_X || stage == LOW_X_OF_32) low_x(along_x(job, 0));
    if (stage == HIGHER) {
        Digit digit = along_x(job, p);
        if (!x_axis) digit = along_y(job, p);
        higher(digit, p);
        if (top) measure();
    }
    if (stage == SHOW || stage == SHOW_LAST_ROW) {
        vec2 range = vec2(height_of_key(~bounds[0]), height_of_key(bounds[1]));
        vec2 stretch = stretch_of(range, normalise);
        bool all_rows = stage == SHOW;
        for (int k = 0; k < (all_rows ? SHOWN : 1); k++) {
            int mine = all_rows ? (job & ~31) * SHOWN + (job & 31) + 32 * k : job;
            show(mine, all_rows ? 0 : count.y, all_rows ? rows : 1, stretch);
        }
    }
}
