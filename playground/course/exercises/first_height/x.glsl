// A kernel of heights: the further east, the higher.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    float x = float(texel.x) / float(size.x - 1);
    return x;
}
