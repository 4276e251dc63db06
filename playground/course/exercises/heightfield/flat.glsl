// A kernel of heights: flat ground, to become a cone.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1);  // 0..1, from the south-west corner
    return 0.0;
}
