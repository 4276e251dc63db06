// scene/near/ladder.glsl -- octaves of detail in metres, from the heightmap's spacing to a pixel.
//
//   gives    COARSEST, RUNGS, cell_of, shown_to, beyond_map, first_rung, last_rung,
//            PixelOnGround, pixel_on_ground
//   needs    nothing: pure functions, no uniforms, no textures
//   units    metres; shares 0..1
//   source   "clamping" of octaves by their frequency: Norton, Rockwood and Skolmoski 1982,
//            "Clamping" (SIGGRAPH), sections 2 and 3; the ladder made here
//   tested   tests/glsl/test_near.py: no rung below two pixels, no jump along a path of the eye
//
// Rung k has cells of 64 m / 2^k, the same ones wherever the eye is, so nothing swims. A cell of
// gradient noise holds half a wave at the most, so that a rung whose cells are two pixels wide is
// at Nyquist's limit: it fades in from there to four pixels. At any distance one rung is fading.
// At the other end, waves of two spacings are the finest that a heightmap holds.
#ifndef SCENE_NEAR_LADDER
#define SCENE_NEAR_LADDER
const float COARSEST = 64.0;
const int RUNGS = 13;  // down to 1.6 cm: places in 32-bit floats are off by millimetres

float cell_of(int rung) { return COARSEST * exp2(-float(rung)); }

// How much of a rung is shown where a pixel is so wide.
float shown_to(float cell, float pixel) {
    return clamp(0.5 * cell / max(pixel, 1e-6) - 1.0, 0.0, 1.0);
}

// How much of it the heightmap does not have already.
float beyond_map(float cell, float spacing) {
    return clamp(2.0 - cell / max(spacing, 1e-6), 0.0, 1.0);
}

// The first rung that is not the heightmap's, and the one after the last that a pixel shows.
int first_rung(float spacing) {
    return clamp(int(floor(log2(0.5 * COARSEST / max(spacing, 1e-6)))) + 1, 0, RUNGS);
}

int last_rung(float pixel) {
    return clamp(int(ceil(log2(0.5 * COARSEST / max(pixel, 1e-6)))), 0, RUNGS);
}

// What a pixel covers: at eye height far more along the view than across it.
struct PixelOnGround {
    vec2 along;    // its longer side
    float wide;    // how long that is
    float finest;  // what is shown at all: a quarter of that, or the shorter side
};

// Of the ways to the points that the next pixels see.
PixelOnGround pixel_on_ground(vec2 right, vec2 up) {
    vec2 along = dot(right, right) > dot(up, up) ? right : up;
    float wide = max(length(along), 1e-6);
    float across = abs(right.x * up.y - right.y * up.x) / wide;
    return PixelOnGround(along, wide, max(across, 0.25 * wide));
}
#endif
