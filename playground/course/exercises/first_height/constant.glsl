// A kernel of heights: every texel has the same height.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    return 0.5;
}
