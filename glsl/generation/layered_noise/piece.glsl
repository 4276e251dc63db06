// generation/layered_noise/piece.glsl -- all layers as one polynomial along each of four columns.
//
//   gives    Piece, piece_at, piece_height, make_fours
//   needs    generation/layered_noise/layers.glsl, generation/normalise/tell.glsl,
//            noise/hash.glsl; the parameters of generation/layered_noise/sum.glsl, declared before
//            it, and a buffer `height:vec4`, (size.x + 3) / 4 fours a row
//   units    heights without unit; rows of texels
//   source   the sum of generation/layered_noise/sum.glsl; the polynomial is derived in
//            generation/layered_noise/bands.glsl
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variants
//
// Only for speed. From one row of nodes to the next, of whatever layer, the sum of all layers is
// a polynomial of degree 3 along each column. Nodes and random numbers are paid once for each such
// piece; a texel costs three products and three sums.
#ifndef GENERATION_LAYERED_NOISE_PIECE
#define GENERATION_LAYERED_NOISE_PIECE
#ifdef COMPUTE_STAGE
#include "generation/layered_noise/layers.glsl"
#include "generation/normalise/tell.glsl"
#include "noise/hash.glsl"

// The factors of 1, v, v² and v³ in four columns, where v counts rows from the first.
struct Piece {
    vec4 c0, c1, c2, c3;
    int begin;  // its first row
    int end;    // the first row beyond it
};

float curve(float a) {
    return interpolation == 0 ? a : a * a * (3.0 - 2.0 * a);
}

// That curve in powers of v, where it is a0 far at v = 0 and rises by `rise` a row.
vec4 curve_by_rows(float a0, float rise) {
    if (interpolation == 0) return vec4(a0, rise, 0.0, 0.0);
    float squared = rise * rise;
    return vec4(curve(a0), 6.0 * a0 * (1.0 - a0) * rise, (3.0 - 6.0 * a0) * squared,
                -2.0 * squared * rise);
}

// The piece that a row is in, in the columns from `x` on. It may begin before the rows of this
// thread and end after them. Columns beyond the terrain are its last one.
Piece piece_at(int x, int row) {
    bool wraps = seams == 0 && tiles > 1;
    int first_layer = layer > 0 ? layer - 1 : left_out;
    int end_layer = layer > 0 ? layer : octaves;
    int maximum = (size.x - 1) * tiles + 1;
    Piece piece = Piece(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), 0, size.y);
    int intervals = 1;
    for (int k = 0; k < end_layer; k++) {
        intervals = finer(intervals, frequency, maximum);
        if (k < first_layer) continue;
        int along_y = intervals_of_part(intervals, tiles, size).y;
        int passed = quotient(row * along_y, size.y);
        piece.begin = max(piece.begin, quotient(passed * size.y + along_y - 1, along_y));
        piece.end = min(piece.end, quotient((passed + 1) * size.y + along_y - 1, along_y));
    }
    intervals = 1;
    float weight = 1.0;
    float weights = 0.0;
    for (int k = 0; k < end_layer; k++) {
        intervals = finer(intervals, frequency, maximum);
        if (layer == 0) weight *= persistence;
        if (k < first_layer) continue;
        uint which = seed_of_layer(seed, random_layers == 1 ? k : 0);
        ivec2 own = intervals_of_part(intervals, tiles, size);
        Nodes y = nodes_around(piece.begin, size.y, own.y, tiles, wraps);
        vec4 south, north;
        for (int i = 0; i < 4; i++) {
            Nodes at = nodes_around(min(x + i, size.x - 1), size.x, own.x, tiles, wraps);
            vec2 west = vec2(random(ivec2(at.first, y.first), which),
                             random(ivec2(at.first, y.second), which));
            vec2 east = vec2(random(ivec2(at.second, y.first), which),
                             random(ivec2(at.second, y.second), which));
            vec2 between = west + (east - west) * curve(at.share);
            south[i] = between.x;
            north[i] = between.y;
        }
        vec4 rise = north - south;
        vec4 powers = curve_by_rows(y.share, 1.0 / float(y.apart));
        piece.c0 += weight * (south + rise * powers.x);
        piece.c1 += weight * (rise * powers.y);
        piece.c2 += weight * (rise * powers.z);
        piece.c3 += weight * (rise * powers.w);
        weights += weight;
    }
    if (overflow == 0 && weights > 0.0) {
        piece.c0 /= weights;
        piece.c1 /= weights;
        piece.c2 /= weights;
        piece.c3 /= weights;
    }
    return piece;
}

vec4 piece_height(Piece piece, float v) {
    vec4 total = piece.c0 + v * (piece.c1 + v * (piece.c2 + v * piece.c3));
    if (overflow < 2) return clamp(total, 0.0, 1.0);
    return total - mix(vec4(0.0), ceil(total) - 1.0, greaterThan(total, vec4(1.0)));
}

const int ROWS = 64;

// The fours of one number in their rows, from row `y` on; what `tells` has their range told.
void make_fours(int four, int y, bool tells) {
    int fours = (size.x + 3) >> 2;
    int last = min(y + ROWS, size.y);
    if (four >= fours) return;
    Told told = nothing_told();
    int at = y * fours + four;
    do {
        Piece piece = piece_at(4 * four, y);
        int stop = min(piece.end, last);
        do {
            vec4 found = piece_height(piece, float(y - piece.begin));
            height[at] = found;
            if (tells) told = told_also(told, found);
            at += fours;
            y++;
        } while (y < stop);
    } while (y < last);
    if (tells) tell(told);
}
#endif
#endif
