// clouds/billows.glsl -- the small round heaps of clouds, in three dimensions, on one texture.
//
//   gives    billows: in r how far a place is within a heap, 0..1, in g the same of the slice
//            above
//   needs    noise/hash.glsl
//   units    without unit
//   source   cells: Worley 1996, "A Cellular Texture Basis Function" (SIGGRAPH); what wears
//            clouds: Schneider 2015, "The Real-Time Volumetric Cloudscapes of Horizon Zero Dawn"
//            (SIGGRAPH course)
//   tested   tests/glsl/test_cloud_light.py: it fits beside its copy; its mean
//
// A cube that repeats is cut into slices, which lie side by side with a border of one texel each.
// So one look at it, between texels and between slices, is one look at the texture.
#include "clouds/billows_reading.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "billows:rg16f")

const uint SALT = 0xa59004bbu;  // CRC-32 of "clouds/billows"

// 1 at a cell's point, 0 a cell away.
float heap_of(vec3 place, int period, uint seed) {
    ivec3 low = ivec3(floor(place));
    float least = 1.0;
    for (int k = 0; k < 27; k++) {
        ivec3 cell = low + ivec3(k % 3, (k / 3) % 3, k / 9) - 1;
        ivec3 key = (cell + period) % period;
        uvec3 bits = hash3(uvec3(key) + uvec3(0u, 0u, seed));
        vec3 point = vec3(cell) + vec3(bits >> 8u) * (1.0 / 16777216.0) - place;
        least = min(least, dot(point, point));
    }
    return 1.0 - least;
}

float heaps_in(ivec3 voxel) {
    vec3 at = (vec3(voxel) + 0.5) / float(BILLOWS);
    return 0.65 * heap_of(at * 4.0, 4, SALT) + 0.35 * heap_of(at * 8.0, 8, SALT + 1024u);
}

vec2 kernel(ivec2 texel) {
    ivec2 tile = texel / (BILLOWS + 2);
    ivec2 inside = (texel - tile * (BILLOWS + 2) + BILLOWS - 1) % BILLOWS;
    int slice = min(tile.x + tile.y * BILLOWS_ACROSS, BILLOWS - 1);
    return vec2(heaps_in(ivec3(inside, slice)), heaps_in(ivec3(inside, (slice + 1) % BILLOWS)));
}
