// A kernel of heights: a wave from west to east, and another from south to north.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    float x = float(texel.x) / float(size.x - 1);
    float y = float(texel.y) / float(size.y - 1);
    return 0.5 + 0.25 * sin(6.2831853 * 3.0 * x) + 0.15 * sin(6.2831853 * 2.0 * y);
}
