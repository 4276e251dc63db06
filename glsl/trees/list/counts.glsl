// trees/list/counts.glsl -- how many trees of each block of cells have a key below a limit.
//
//   gives    count
//   needs    keys of trees/place; a limit in one texel, 1 where none is wired
//   units    trees
//   source   Ziegler, Tevs, Theobalt and Seidel 2006, "On-the-fly Point Clouds through Histogram
//            Pyramids" (VMV): one level of it
//   tested   tests/glsl/test_trees.py
#pragma kernel(output = "count:r32f")

uniform sampler2D key;    //! input
uniform sampler2D limit;  //! input("white")

float kernel(ivec2 texel) {
    ivec2 cells = textureSize(key, 0);
    ivec2 block = (cells + size - 1) / size;
    ivec2 low = texel * block;
    ivec2 high = min(low + block, cells);
    float maximum = texelFetch(limit, ivec2(0), 0).r;
    float total = 0.0;
    for (int y = low.y; y < high.y; y++) {
        for (int x = low.x; x < high.x; x++) {
            if (texelFetch(key, ivec2(x, y), 0).r < maximum) total += 1.0;
        }
    }
    return total;
}
