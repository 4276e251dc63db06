// A kernel of heights: a wave from west to east.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    float x = float(texel.x) / float(size.x - 1);
    return 0.5 + 0.25 * sin(6.2831853 * 3.0 * x);
}
