// view/antialias.glsl -- a picture's edges smoothed after it is made, where steps are seen.
//
//   gives    frame, encoded as what it begins with
//   needs    an encoded picture as `initial`
//   units    encoded colours 0..1; pixels
//   source   after Lottes 2009, "FXAA" (NVIDIA white paper): steps are found by luma, an edge is
//            followed to both ends of its step, and the nearer end says how far to blend across;
//            written anew, with fetches only, and without its subpixel filter
//   tested   tests/glsl/test_after.py, against exact cover of half planes in float64
//
// What lights pixels after they are drawn has one sample of each; more of them (`supersample` of
// a shot) are exact, and cost as many pictures. Straight edges along rows and columns stay.
#pragma kernel(output = "frame:rgba8", repeat = "1 if antialias else 0")

uniform bool antialias = true;     //! group("Picture") Smooth the steps of edges
uniform float threshold = 0.04;    //! slider(0.01, 0.5) step(0.005) group("Picture")
                                   //! How much an edge stands out to be smoothed

const int LONGEST = 12;  // pixels that an edge is followed each way

float luma(ivec2 texel) {
    return dot(previous(texel).rgb, vec3(0.299, 0.587, 0.114));
}

// How far along `direction` the edge goes on, and in `ends` the middle of its two sides there.
int followed(ivec2 texel, ivec2 direction, ivec2 across, float middle, float rise,
             out float ends) {
    ends = 0.0;
    int far = 0;
    for (int k = 1; k <= LONGEST; k++) {
        ivec2 there = texel + direction * k;
        ends = 0.5 * (luma(there) + luma(there + across)) - middle;
        far = k;
        if (abs(ends) >= 0.25 * rise) break;
    }
    return far;
}

vec4 kernel(ivec2 texel) {
    vec4 own = previous(texel);
    float here = luma(texel);
    float north = luma(texel + ivec2(0, 1)), south = luma(texel - ivec2(0, 1));
    float east = luma(texel + ivec2(1, 0)), west = luma(texel - ivec2(1, 0));
    float maximum = max(here, max(max(north, south), max(east, west)));
    float least = min(here, min(min(north, south), min(east, west)));
    if (maximum - least < threshold) return own;
    // Second differences say whether the edge runs along rows or along columns.
    float north_east = luma(texel + ivec2(1, 1)), north_west = luma(texel + ivec2(-1, 1));
    float south_east = luma(texel + ivec2(1, -1)), south_west = luma(texel - ivec2(1, 1));
    float rows = abs(north_west + south_west - 2.0 * west)
            + 2.0 * abs(north + south - 2.0 * here)
            + abs(north_east + south_east - 2.0 * east);
    float columns = abs(north_west + north_east - 2.0 * north)
            + 2.0 * abs(west + east - 2.0 * here)
            + abs(south_west + south_east - 2.0 * south);
    bool level = rows >= columns;
    ivec2 along = level ? ivec2(1, 0) : ivec2(0, 1);
    ivec2 across = along.yx;
    float before = (level ? south : west) - here, after = (level ? north : east) - here;
    if (abs(before) > abs(after)) across = -across;
    float rise = max(abs(before), abs(after));
    float middle = here + 0.5 * (abs(before) > abs(after) ? before : after);
    float first, last;
    int back = followed(texel, -along, across, middle, rise, first);
    int ahead = followed(texel, along, across, middle, rise, last);
    // The edge leaves this pixel's row at the nearer end, or it does not: then the pixel is whole.
    float end = back < ahead ? first : last;
    bool leaves = (here < middle) != (end < 0.0) && abs(end) >= 0.25 * rise;
    float part = 0.5 - (float(min(back, ahead)) - 0.5) / float(back + ahead - 1);
    return leaves ? mix(own, previous(texel + across), max(part, 0.0)) : own;
}
