// water/accumulation/tree.glsl -- the ways of the water as a binary tree.
//
//   gives    node: red what falls on a texel, green its first donor, blue its next sibling, both
//            numbers of texels or -1
//   needs    maths/land.glsl, terrain/heightfield.glsl, water/texels.glsl
//   units    cells, times the rain, which may have a size of its own
//   source   the tree of first child and next sibling: Knuth, The Art of Computer Programming,
//            volume 1, section 2.3.2
//   tested   tests/glsl/test_accumulation.py
//
// A texel may have eight donors, and a texture's texel holds four numbers. Here a texel knows one
// donor, and each donor the next one of the same receiver.
#include "maths/land.glsl"
#include "terrain/heightfield.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "node:rgba32f", \
               accepts = "n up to 4096, m up to 4096")

uniform sampler2D receiver;  //! input
uniform sampler2D rain;      //! input("white")

// The first texel around a middle, from a place on, that drains to it; -1 where none does.
float donor_of(ivec2 middle, int from) {
    float own = number_of(middle, size);
    for (int k = from; k < NEIGHBOURS; k++) {
        ivec2 there = middle + neighbour_of(k);
        if (!inside(there, size)) continue;
        if (texelFetch(receiver, there, 0).r == own) return number_of(there, size);
    }
    return -1.0;
}

vec4 kernel(ivec2 texel) {
    ivec2 down = texel_of(texelFetch(receiver, texel, 0).r, size);
    ivec2 back = texel - down;
    int place = 3 * (back.y + 1) + back.x + 1;
    int after = place < 4 ? place + 1 : place;
    bool drains = back != ivec2(0) && all(lessThanEqual(abs(back), ivec2(1)));
    float sibling = drains ? donor_of(down, after) : -1.0;
    float falls = 1.0;
    if (wired_rain) {
        falls = max(height_at(rain, place_on(textureSize(rain, 0), texel, size)), 0.0);
    }
    return vec4(falls, donor_of(texel, 0), sibling, 0.0);
}
