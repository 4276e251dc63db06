// erosion/stream_power/hillside.glsl -- hillsides: no steeper than they stand, rounded by creep.
//
//   gives    height
//   needs    erosion/stream_power/parameters/time.glsl, water/texels.glsl
//   units    heights without unit; parameters in metres, years and degrees
//   source   creep: Culling 1960, "Analytical theory of erosion": dz/dt = D lap z, implicit;
//            landslides as in Cordonnier et al. 2016, "Large scale terrain generation from
//            tectonic uplift and fluvial erosion", section 4.3
//   tested   tests/glsl/test_stream_power.py, by slopes and by the law without them
//
// The Laplacian is that of nine points, the same along the axes as along the diagonals to third
// order where spacings are equal, and right along both axes where they are not. Each step is
// implicit in its own texel, so none is too long.
#include "erosion/stream_power/parameters/time.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "height:r32f", repeat = "slides")

uniform sampler2D link;          //! input
uniform int slides = 4;          //! slider(1, 64) Steps of the hillsides in one of the rivers
uniform float steepest = 40.0;   //! slider(1, 89) step(1) unit("°") Beyond it hillsides slide
uniform float creep = 0.02;    //! slider(0, 10) step(0.001) unit("m2/yr") How fast soil moves

float height_before(ivec2 texel) {
    return iteration == 0 ? texelFetch(link, texel, 0).r : previous(texel);
}

float kernel(ivec2 texel) {
    float here = height_before(texel);
    if (on_edge(texel, size)) return here;
    float rise = tan(radians(clamp(steepest, 1.0, 89.0))) / max(relief, 1e-3);
    float years = 1e6 * age / float(max(steps, 1) * max(slides, 1));
    float maximum = 1e30;
    float sum = 0.0;
    float weights = 0.0;
    for (int k = 0; k < NEIGHBOURS; k++) {
        vec2 offset = vec2(neighbour_of(k)) * spacing;
        float there = height_before(texel + neighbour_of(k));
        float squared = dot(offset, offset);
        maximum = min(maximum, there + rise * sqrt(squared));
        // 2/3 and 1/6 of a square grid's nine points; where the spacings differ, what the corners
        // do not give along each axis its two neighbours give.
        float corner = 1.0 / (3.0 * dot(spacing, spacing));
        bool straight = neighbour_of(k).x * neighbour_of(k).y == 0;
        float weight = straight ? 1.0 / squared - 2.0 * corner : corner;
        sum += weight * there;
        weights += weight;
    }
    float share = years * creep;
    return min((here + share * sum) / (1.0 + share * weights), maximum);
}
