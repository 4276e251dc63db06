// water/rivers.glsl -- rivers as smooth lines of their own width, drawn at any size.
//
//   gives    river, the share of a texel that it covers, 0..1; width of the nearest river there
//   needs    maths/land.glsl, maths/power.glsl, water/texels.glsl
//   units    widths in metres, areas in m^2; parameters in km^2
//   source   widths: Leopold and Maddock 1953, "The hydraulic geometry of stream channels", USGS
//            Professional Paper 252: about the root of the discharge; the lines made here
//   tested   tests/glsl/test_rivers.py, against the area of lines of known width
//
// The ways go from texel to texel in eight directions. A river goes through the middles between
// its texels instead, bent towards each texel on the way: quadratic Bezier curves, so it has no
// corner. Wherever it is narrower than a texel of this pass it covers a share of it.
#include "maths/land.glsl"
#include "maths/power.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "river:r32f, width:r32f")

uniform sampler2D receiver;    //! input
uniform sampler2D area;        //! input
uniform float source = 0.5;    //! log_slider(0.001, 100) unit("km2") Drained where a river begins
uniform float wide = 6.0;      //! slider(0, 100) step(0.1) unit("m") Width where it drains 1 km2
uniform float growth = 0.5;    //! slider(0, 1) step(0.01) The power of the area by which it widens

const int PIECES = 4;  // straight ones of each curve

ivec2 grid() { return textureSize(receiver, 0); }

float area_at(ivec2 node) { return texelFetch(area, node, 0).r; }

// No wider than two spacings: a texel looks no farther than its next nodes.
float width_of(float drained, vec2 metres) {
    return min(wide * power(max(1e-6 * drained, 1e-9), growth), 2.0 * min(metres.x, metres.y));
}

ivec2 direction_from(ivec2 node) {
    return clamp(texel_of(texelFetch(receiver, node, 0).r, grid()) - node, ivec2(-1), ivec2(1));
}

// How much a texel of some metres is covered by one curve; and the curve's width there.
vec2 cover_of(vec2 place, vec2 from, vec2 through, vec2 to, vec2 widths, float texel_metres) {
    vec2 best = vec2(0.0);
    vec2 start = from;
    for (int k = 1; k <= PIECES; k++) {
        float t = float(k) / float(PIECES);
        vec2 end = mix(mix(from, through, t), mix(through, to, t), t);
        vec2 along = end - start;
        float share = clamp(dot(place - start, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
        float width = mix(widths.x, widths.y, t + (share - 1.0) / float(PIECES));
        float offset = length(place - start - share * along);
        float drawn = max(width, texel_metres);
        float cover = clamp((0.5 * drawn - offset) / texel_metres + 0.5, 0.0, 1.0) * width / drawn;
        if (cover > best.x) best = vec2(cover, width);
        start = end;
    }
    return best;
}

vec2 river_of(ivec2 node, vec2 place, vec2 metres, float texel_metres) {
    float drained = area_at(node);
    if (!(drained >= 1e6 * source)) return vec2(0.0);
    vec2 through = vec2(node) * metres;
    vec2 to = through + 0.5 * vec2(direction_from(node)) * metres;
    float width = width_of(drained, metres);
    vec2 best = vec2(0.0);
    bool spring = true;
    for (int k = 0; k < NEIGHBOURS; k++) {
        ivec2 donor = node + neighbour_of(k);
        if (!inside(donor, grid()) || donor + direction_from(donor) != node) continue;
        float brings = area_at(donor);
        if (!(brings >= 1e6 * source)) continue;
        spring = false;
        vec2 from = 0.5 * (through + vec2(donor) * metres);
        vec2 widths = vec2(width_of(brings, metres), width);
        vec2 found = cover_of(place, from, through, to, widths, texel_metres);
        if (found.x > best.x) best = found;
    }
    return spring ? cover_of(place, through, through, to, vec2(width), texel_metres) : best;
}

void kernel(ivec2 texel, out float river, out float width) {
    vec2 metres = spacing_of(grid(), extent);
    vec2 place = share_of_texel(texel, size) * extent;
    float texel_metres = 0.5 * (spacing.x + spacing.y);
    ivec2 corner = ivec2(place_on(grid(), texel, size));
    vec2 best = vec2(0.0);
    for (int y = -1; y <= 2; y++) {
        for (int x = -1; x <= 2; x++) {
            ivec2 node = corner + ivec2(x, y);
            if (!inside(node, grid())) continue;
            vec2 found = river_of(node, place, metres, texel_metres);
            if (found.x > best.x) best = found;
        }
    }
    river = best.x;
    width = best.y;
}
