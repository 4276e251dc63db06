// A kernel of heights: a cone in the middle of a plain.
#pragma kernel(output = "height:r32f")

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(size - 1);  // 0..1, from the south-west corner
    return max(1.0 - 2.0 * length(place - 0.5), 0.0);
}
