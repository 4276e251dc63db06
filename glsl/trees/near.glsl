// trees/near.glsl -- how far a tree is on its way from a crown far away to sprays of leaves.
//
//   gives    near_share, CORE
//   needs    nothing: pure functions, no uniforms, no textures
//   units    metres; 0 to 1
//   source   none
//   tested   tests/glsl/test_trees_near.py
#ifndef TREES_NEAR
#define TREES_NEAR

const float CORE = 0.70;  // of a crown, what its body is amid sprays

// 1 where sprays are whole, 0 where the crown is one body.
float near_share(float eye_distance, float near) {
    return 1.0 - smoothstep(0.5 * near, near, eye_distance);
}
#endif
