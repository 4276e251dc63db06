// A kernel of heights, empty: every texel has the height 0.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    return 0.0;
}
