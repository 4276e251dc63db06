// generation/deterministic_fractal/folds.glsl -- distances to self-similar sets, by folds.
//
//   gives    KOCH_CURVE and the other sets' names, copies_of, distance_to_set, cantor_bars
//   needs    nothing: pure functions, no uniforms, no textures
//   units    the set is 1 wide, in the middle of the plane; distances in the same, 0 inside
//   source   Belaiche 2010, section 1.2.1: n copies of itself at the scale r; the sets of
//            Cantor 1883, Koch 1904, Sierpinski 1915 and 1916, and Vicsek 1983
//   tested   tests/glsl/test_deterministic_fractal.py, against distances to every piece
//
// Where a set has a mirror, the nearest of its points lies on the same side as the place p. So a
// fold along each mirror leaves one copy that can be nearest; it is enlarged to the size of the
// whole, and folded again. After `depth` steps the piece left is a segment, a square or a
// triangle:
//
//     distance(p) = r^depth far_from_piece(fold(fold(.. p) / r) / r)
//
// This is exact, and costs one copy a step, not n.
#ifndef GENERATION_DETERMINISTIC_FRACTAL_FOLDS
#define GENERATION_DETERMINISTIC_FRACTAL_FOLDS

const float THIRD = 1.0 / 3.0;
const float SIXTH = 1.0 / 6.0;
const float ROOT_3 = 1.7320508;

// The sets, in the order of their dimension.
const int CANTOR_SET = 0;
const int KOCH_CURVE = 1;
const int CANTOR_DUST = 2;
const int VICSEK_CROSS = 3;
const int SIERPINSKI_TRIANGLE = 4;
const int SIERPINSKI_CARPET = 5;

// How many copies a set is made of, and how many of them side by side are as wide as it: 1/r.
ivec2 copies_of(int set) {
    if (set == CANTOR_SET) return ivec2(2, 3);
    if (set == VICSEK_CROSS) return ivec2(5, 3);
    if (set == SIERPINSKI_TRIANGLE) return ivec2(3, 2);
    if (set == SIERPINSKI_CARPET) return ivec2(8, 3);
    return ivec2(4, 3);
}

// From a place to a box around the middle.
float far_from_box(vec2 place, vec2 half_sides) {
    return length(max(abs(place) - half_sides, 0.0));
}

// The set of the last step below, and above it those of the steps before.
float cantor_bars(vec2 place, int depth) {
    float row = 1.0 / float(depth + 1);
    float x = place.x;
    float scale = 1.0;
    float nearest = 1e9;
    for (int k = 0; k <= depth; k++) {
        float outside = max(abs(x) - 0.5, 0.0) * scale;
        float up = max(abs(place.y - 0.5 + (float(k) + 0.5) * row) - 0.3 * row, 0.0);
        nearest = min(nearest, length(vec2(outside, up)));
        x = (abs(x) - THIRD) * 3.0;
        scale *= THIRD;
    }
    return nearest;
}

// The eighth of the plane east of the middle, up to the diagonal.
vec2 into_eighth(vec2 place) {
    place = abs(place);
    return place.x < place.y ? place.yx : place;
}

// The sixth of the plane east of north, down to 30 degrees: half a triangle's upper third.
vec2 into_sixth(vec2 place) {
    const vec2 across = vec2(-0.5, 0.5 * ROOT_3);
    place.x = abs(place.x);
    place -= 2.0 * min(dot(place, across), 0.0) * across;
    place.x = abs(place.x);
    return place;
}

// Where a place lies on the copy that can be nearest, from that copy's middle.
vec2 fold(int set, vec2 place) {
    if (set == KOCH_CURVE) {
        // Of each segment the middle third makes way for two sides of a triangle. From the
        // curve's foot at 1/6 the mirror of its right half rises at 60 degrees.
        const vec2 across = vec2(-0.5 * ROOT_3, 0.5);
        place.x = abs(place.x) - SIXTH;
        place -= 2.0 * max(dot(place, across), 0.0) * across;
        return vec2(place.x - SIXTH, place.y);
    }
    if (set == VICSEK_CROSS) {
        // A square's middle, and the four squares beside it.
        place = into_eighth(place);
        return vec2(abs(place.x - SIXTH) - SIXTH, place.y);
    }
    if (set == SIERPINSKI_CARPET) {
        // A square without its middle.
        place = into_eighth(place);
        return vec2(place.x - THIRD, SIXTH - abs(place.y - SIXTH));
    }
    if (set == SIERPINSKI_TRIANGLE) {
        // A triangle without its middle.
        return into_sixth(place) - vec2(0.0, 0.5 / ROOT_3);
    }
    // Of dust, a square's four corners.
    return abs(place) - THIRD;
}

float far_from_piece(int set, vec2 place) {
    if (set == SIERPINSKI_TRIANGLE) {
        // Beyond the side, whose middle is at 30 degrees, and beyond the top along it.
        place = into_sixth(place);
        float beyond_side = dot(place, vec2(0.5 * ROOT_3, 0.5)) - 0.5 / ROOT_3;
        float beyond_top = dot(place, vec2(-0.5, 0.5 * ROOT_3)) - 0.5;
        return length(max(vec2(beyond_side, beyond_top), 0.0));
    }
    return far_from_box(place, vec2(0.5, set == KOCH_CURVE ? 0.0 : 0.5));
}

float distance_to_set(int set, vec2 place, int depth) {
    // The lower side of a curve's box, a third of a triangle's height below its middle.
    if (set == KOCH_CURVE || set == SIERPINSKI_TRIANGLE) place.y += 0.25 / ROOT_3;
    float larger = float(copies_of(set).y);
    float scale = 1.0;
    for (int k = 0; k < depth; k++) {
        place = larger * fold(set, place);
        scale /= larger;
    }
    return scale * far_from_piece(set, place);
}
#endif
