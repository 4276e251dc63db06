// generation/deterministic_fractal/folds.glsl -- distances to self-similar sets, by folding the plane along their mirrors.
//
//   gives    cantor_bars, koch_curve, cantor_dust, vicsek_cross, sierpinski_triangle, sierpinski_carpet
//   needs    nothing: pure functions, no uniforms, no textures
//   units    the set is 1 wide, in the middle of the plane; distances in the same, 0 inside
//   source   Belaiche 2010, section 1.2.1: n copies of itself at the scale r; the sets of
//            Cantor 1883, Koch 1904, Sierpinski 1915 and 1916, and Vicsek 1983
//   tested   tests/glsl/test_deterministic_fractal.py, against distances to every piece
//
// Where a set has a mirror, the nearest of its points lies on the same side as the place that
// asks. So a fold along each mirror leaves one copy that can be nearest; it is enlarged to the
// size of the whole, and asked in turn. After `depth` turns the piece left is a segment, a
// square or a triangle. This is exact, and costs one copy a turn, not n.
#ifndef GENERATION_DETERMINISTIC_FRACTAL_FOLDS
#define GENERATION_DETERMINISTIC_FRACTAL_FOLDS

const float THIRD = 1.0 / 3.0;
const float SIXTH = 1.0 / 6.0;
const float ROOT_3 = 1.7320508;

// From a place to a box around the middle.
float far_from_box(vec2 place, vec2 half_sides) {
    return length(max(abs(place) - half_sides, 0.0));
}

// n = 2, r = 1/3: the set of the last turn below, and above it those of the turns before.
float cantor_bars(vec2 place, int depth) {
    float row = 1.0 / float(depth + 1);
    float x = place.x;
    float scale = 1.0;
    float nearest = 1e9;
    for (int turn = 0; turn <= depth; turn++) {
        float outside = max(abs(x) - 0.5, 0.0) * scale;
        float up = max(abs(place.y - 0.5 + (float(turn) + 0.5) * row) - 0.3 * row, 0.0);
        nearest = min(nearest, length(vec2(outside, up)));
        x = (abs(x) - THIRD) * 3.0;
        scale *= THIRD;
    }
    return nearest;
}

// n = 4, r = 1/3: the middle third of each segment makes way for two sides of a triangle.
float koch_curve(vec2 place, int depth) {
    place.y += 0.25 / ROOT_3;
    float scale = 1.0;
    // From the curve's foot at 1/6 the mirror of its right half rises at 60 degrees.
    const vec2 across = vec2(-0.5 * ROOT_3, 0.5);
    for (int turn = 0; turn < depth; turn++) {
        place.x = abs(place.x) - SIXTH;
        place -= 2.0 * max(dot(place, across), 0.0) * across;
        place.x -= SIXTH;
        place *= 3.0;
        scale *= THIRD;
    }
    return far_from_box(place, vec2(0.5, 0.0)) * scale;
}

// n = 4, r = 1/3: a square's four corners.
float cantor_dust(vec2 place, int depth) {
    float scale = 1.0;
    for (int turn = 0; turn < depth; turn++) {
        place = (abs(place) - THIRD) * 3.0;
        scale *= THIRD;
    }
    return far_from_box(place, vec2(0.5)) * scale;
}

// The eighth of the plane east of the middle, up to the diagonal.
vec2 into_eighth(vec2 place) {
    place = abs(place);
    return place.x < place.y ? place.yx : place;
}

// n = 5, r = 1/3: a square's middle, and the four squares beside it.
float vicsek_cross(vec2 place, int depth) {
    float scale = 1.0;
    for (int turn = 0; turn < depth; turn++) {
        place = into_eighth(place);
        place.x = abs(place.x - SIXTH) - SIXTH;
        place *= 3.0;
        scale *= THIRD;
    }
    return far_from_box(place, vec2(0.5)) * scale;
}

// n = 8, r = 1/3: a square without its middle.
float sierpinski_carpet(vec2 place, int depth) {
    float scale = 1.0;
    for (int turn = 0; turn < depth; turn++) {
        place = into_eighth(place);
        place = vec2(place.x - THIRD, SIXTH - abs(place.y - SIXTH)) * 3.0;
        scale *= THIRD;
    }
    return far_from_box(place, vec2(0.5)) * scale;
}

// The sixth of the plane east of north, down to 30 degrees: half a triangle's upper third.
vec2 into_sixth(vec2 place) {
    const vec2 across = vec2(-0.5, 0.5 * ROOT_3);
    place.x = abs(place.x);
    place -= 2.0 * min(dot(place, across), 0.0) * across;
    place.x = abs(place.x);
    return place;
}

// n = 3, r = 1/2: a triangle without its middle.
float sierpinski_triangle(vec2 place, int depth) {
    place.y += 0.25 / ROOT_3;
    float scale = 1.0;
    for (int turn = 0; turn < depth; turn++) {
        place = into_sixth(place);
        place = vec2(place.x, place.y - 0.5 / ROOT_3) * 2.0;
        scale *= 0.5;
    }
    place = into_sixth(place);
    // Beyond the side, whose middle stands at 30 degrees, and beyond the top along it.
    vec2 outside = vec2(dot(place, vec2(0.5 * ROOT_3, 0.5)) - 0.5 / ROOT_3, dot(place, vec2(-0.5, 0.5 * ROOT_3)) - 0.5);
    return length(max(outside, 0.0)) * scale;
}
#endif
