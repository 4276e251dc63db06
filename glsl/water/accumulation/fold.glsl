// water/accumulation/fold.glsl -- a binary tree summed by folding: each texel's whole subtree.
//
//   gives    node: red the sum of the subtree below and of the siblings after, once green and blue
//            are -1; until then they are what is still to be added
//   needs    water/texels.glsl
//   units    as the numbers that are summed
//   source   Miller and Reif 1985, "Parallel tree contraction and its application": rake and
//            compress; on terrains Jain et al. 2024, "FastFlow: GPU acceleration of flow and
//            depression routing for landscape simulation"
//   tested   tests/glsl/test_accumulation.py, against serial counting, number by number
//
// In each step a texel looks at what it still has to add. What has nothing left to add itself is
// added (rake). What has something left hands its own sum and its own links over, where the two
// places suffice (compress): so a chain without branches is half as long after each step.
// Whole numbers below 2^24 are summed exactly, in any order.
#include "water/texels.glsl"
#pragma kernel(output = "node:rgba32f", repeat = "4 * bits(size.x * size.y)", \
                until = "unchanged")

const vec4 NOTHING = vec4(0.0, -1.0, -1.0, 0.0);

int links_of(vec4 node) {
    return int(node.y >= 0.0) + int(node.z >= 0.0);
}

vec2 joined(vec2 links, float link) {
    if (link < 0.0) return links;
    return links.x < 0.0 ? vec2(link, -1.0) : vec2(links.x, link);
}

vec4 kernel(ivec2 texel) {
    vec4 node = previous(texel);
    if (links_of(node) == 0) return node;
    vec4 first = node.y < 0.0 ? NOTHING : previous(texel_of(node.y, size));
    vec4 second = node.z < 0.0 ? NOTHING : previous(texel_of(node.z, size));
    // What a link is replaced by must find room beside the other link.
    bool opens_first = node.y >= 0.0 && links_of(first) + int(node.z >= 0.0) <= 2;
    int left = opens_first ? links_of(first) : int(node.y >= 0.0);
    bool opens_second = node.z >= 0.0 && links_of(second) + left <= 2;
    // anchor: fold
    float sum = node.x + (opens_first ? first.x : 0.0) + (opens_second ? second.x : 0.0);
    vec2 links = vec2(-1.0);
    links = joined(links, opens_first ? first.y : node.y);
    if (opens_first) links = joined(links, first.z);
    links = joined(links, opens_second ? second.y : node.z);
    if (opens_second) links = joined(links, second.z);
    // end: fold
    return vec4(sum, links, 0.0);
}
