// clouds/field/shape.glsl -- where clouds grow first and tallest, on a tile that repeats.
//
//   gives    shape: how readily a cloud is there, about 0..1; what wears it away; its round heaps
//   needs    noise/periodic.glsl
//   units    without unit
//   source   gradient noise and heaps of cells, as in Schneider 2015, "The Real-Time Volumetric
//            Cloudscapes of Horizon Zero Dawn" (SIGGRAPH course), here in the plane
//   tested   tests/glsl/test_clouds.py: it fits beside its copy
#include "noise/periodic.glsl"
#pragma kernel(output = "shape:rgba16f")

uniform int across = 4;    //! slider(1, 32) Groups of clouds from side to side
uniform uint seed = 3u;    //! slider(0, 9999) Which clouds

const int HEAPS = 3;       // cells in a group, from side to side, of the largest heaps
const uint SALT = 0x0603c45eu;  // CRC-32 of "clouds/field"

vec4 kernel(ivec2 texel) {
    vec2 at = (vec2(texel) + 0.5) / vec2(size) * float(across);
    ivec2 period = ivec2(across);
    uint first = 64u * seed + SALT;
    vec2 bend = vec2(gradient_noise_periodic(at * 2.0, period * 2, first + 40u),
                     gradient_noise_periodic(at * 2.0, period * 2, first + 41u));
    vec2 moved = at + 0.15 * bend;
    // Round tops where cells have their points.
    float heaps = 0.0;
    float strength = 2.0 / 3.0;
    for (int k = 0; k < 2; k++) {
        int fine = HEAPS << k;
        vec3 cells = cells_periodic(moved * float(fine), period * fine, first + 7u + uint(k));
        heaps += strength * (1.0 - min(cells.x * cells.x, 1.0));
        strength *= 0.5;
    }
    float groups = 0.5 + 0.9 * gradient_fbm_periodic(moved, period, 3, 0.5, first);
    float fine = gradient_fbm_periodic(moved * 16.0, period * 16, 3, 0.55, first + 21u);
    return vec4(0.75 * groups + 0.45 * heaps - 0.1, 0.5 + 0.5 * fine, heaps, 1.0);
}
