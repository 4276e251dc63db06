// generation/circles/dome.glsl -- the height of a dome over a disc.
//
//   gives    disc_share, dome_of_share, shorter_side
//   needs    nothing: pure functions, no uniforms, no textures
//   units    places in the terrain's shorter side, so that discs are round in metres
//   source   Belaiche 2010, section 1.3.7; half a cosine as a dome is common for this method
//   tested   tests/glsl/test_marks.py, against the same curves in Python
#ifndef GENERATION_CIRCLES_DOME
#define GENERATION_CIRCLES_DOME

// Metres of the shorter side: what a place and a radius are measured in.
float shorter_side(vec2 metres) {
    return max(min(metres.x, metres.y), 1e-30);
}

// The square of how far out a place lies: 0 in the disc's middle, 1 and more from its rim on.
float disc_share(vec2 offset, float radius) {
    float squared = radius * radius;
    float far = dot(offset, offset);
    return far < squared ? far / squared : 1.0;
}

// 1 in the middle, 0 at the rim: half a cosine, level at both, or a half sphere, vertical at the
// rim.
float dome_of_share(float share, bool sphere) {
    return sphere ? sqrt(max(1.0 - share, 0.0)) : 0.5 * cos(3.14159265 * sqrt(share));
}
#endif
