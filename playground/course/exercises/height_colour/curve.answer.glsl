// texturing/height_weights.glsl -- how much of grass, rock and snow a height gets.
//
//   gives    height_weights
//   needs    nothing: pure functions, no uniforms, no textures
//   units    height and thresholds in the same unit; weights 0..1, summing to 1
//   source   Belaiche 2010, section 2.3.2, Terrain_RemplitPerc
//   tested   tests/glsl/test_height_blend.py, against linear interpolation of the
//            thesis's table of heights
//
//   weight   1 |-----.           .--------.           .-----
//              | grass \       /   rock     \       /  snow
//            0 |---------.---.----------------.---.--------> height
//                      x     y              z     w   (thresholds)
#ifndef TEXTURING_HEIGHT_WEIGHTS
#define TEXTURING_HEIGHT_WEIGHTS

// 0 below `from`, 1 from `to` up, linear between. No division where the two are the same.
float share_between(float height, float from, float to) {
    if (height < from) return 0.0;
    float a = height >= to ? 1.0 : (height - from) / (to - from);
    return a * a * (3.0 - 2.0 * a);
}

// Weights of grass, rock and snow. Rock takes from grass, then snow from both: so they
// sum to 1 even where the thresholds are out of order.
vec3 height_weights(float height, vec4 thresholds) {
    float bare = share_between(height, thresholds.x, thresholds.y);
    float covered = share_between(height, thresholds.z, thresholds.w);
    return vec3((1.0 - bare) * (1.0 - covered), bare * (1.0 - covered), covered);
}
#endif
