// trees/list/sum.glsl -- the sum of each block of a texture's numbers.
//
//   gives    total
//   needs    counts; as many blocks as this pass has texels
//   units    as the counts
//   source   none
//   tested   tests/glsl/test_trees.py
#pragma kernel(output = "total:r32f")

uniform sampler2D count;  //! input

float kernel(ivec2 texel) {
    ivec2 cells = textureSize(count, 0);
    ivec2 block = (cells + size - 1) / size;
    ivec2 low = texel * block;
    ivec2 high = min(low + block, cells);
    float total = 0.0;
    for (int y = low.y; y < high.y; y++) {
        for (int x = low.x; x < high.x; x++) total += texelFetch(count, ivec2(x, y), 0).r;
    }
    return total;
}
