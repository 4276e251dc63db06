// trees/in_time.glsl -- which trees of a row are drawn while the eye comes nearer.
//
//   gives    drawn: 1 for a tree that is drawn, a column for each; a row for each picture
//   needs    noise/hash.glsl
//   units    metres
//   source   Cook, Halstead, Planck and Ryu 2007, "Stochastic Simplification of Aggregate Detail"
//            (SIGGRAPH)
//   tested   tests/glsl/test_lesson_outdoors.py: once drawn, a tree stays; how many are
//
// The thinning of trees/level.glsl along one line, without the fade at its end.
#include "noise/hash.glsl"
#pragma kernel(output = "drawn:r32f")

uniform float start = 4000.0;  //! log_slider(100, 20000) unit("m") How far the eye is at first
uniform float whole = 1000.0;  //! log_slider(10, 5000) unit("m") All are drawn up to here
uniform uint seed = 1u;        //! slider(0, 9999) Which trees

const int WIDE = 4;             // texels for a tree, and for a picture
const uint SALT = 0xf0b117c6u;  // CRC-32 of "lessons/trees_in_time"

float kernel(ivec2 texel) {
    int tree = texel.x / WIDE;
    int picture = (size.y - 1 - texel.y) / WIDE;  // the first on top
    float eye_distance = start * (1.0 - float(picture) / float(size.y / WIDE));
    // anchor: thinning
    float near = min(whole / max(eye_distance, 1.0), 1.0);
    float kept = near * near;
    float rank = random(ivec2(tree, 0), seed + SALT);
    bool stays = rank < kept;
    // end: thinning
    return stays ? 1.0 : 0.0;
}
