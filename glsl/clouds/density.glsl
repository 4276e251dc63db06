// clouds/density.glsl -- how dense heaped clouds are at a place of their layer.
//
//   gives    density_at, worn, Wear, WORN_MOST
//   needs    clouds/layer_form.glsl, clouds/billows_reading.glsl
//   units    places across in tiles, heights and thicknesses in the tallest; densities 0..1 of
//            the most extinction
//   source   a flat foot, a round top, and small noise that wears its sides away: Schneider 2015,
//            "The Real-Time Volumetric Cloudscapes of Horizon Zero Dawn" (SIGGRAPH course)
//   tested   tests/glsl/test_cloud_light.py: light goes through the same in float64;
//            tests/glsl/test_cloud_pictures.py: they keep the cover
#ifndef CLOUDS_DENSITY
#define CLOUDS_DENSITY
#include "clouds/billows_reading.glsl"
#include "clouds/layer_form.glsl"

const float BILLOWS_WIDE = 900.0;  // [m] of a cube of billows
const int FINER = 5;               // cubes of the finer ones in one of them, on each axis

// Extinction as a share of the most, `up` in a cloud of a thickness.
float density_at(float thick, float up) {
    return clamp((thick - up) * CLOUD_STEEP, 0.0, 1.0) * smoothstep(0.0, CLOUD_FOOT, up);
}

struct Wear {
    float cubes;   // of billows in a tile, on each axis: a whole number
    float large;   // how far the large ones reach in or out, in the tallest
    float small;   // the finer ones
};

// What a picture shows of them whose pixel is so many metres wide at the clouds.
Wear wear_of(float tile, float much, float pixel) {
    float cubes = max(floor(tile / BILLOWS_WIDE + 0.5), 1.0);
    float voxel = tile / (cubes * float(BILLOWS));
    return Wear(cubes, 0.9 * much * clamp(3.0 - pixel / voxel, 0.0, 1.0),
                0.3 * much * clamp(3.0 - pixel * float(FINER) / voxel, 0.0, 1.0));
}

// The thickness of a cloud with its heaps, from that without: near its foot they are less.
float worn(sampler2D billows, Wear wear, vec2 at, float thick, float up, float tile) {
    if (wear.large <= 0.0) return thick;
    vec3 place = vec3(at, up * CLOUD_TALL / tile) * wear.cubes;
    float heaps = wear.large * (billows_at(billows, place) - BILLOWS_MEAN);
    if (wear.small > 0.0) {
        heaps += wear.small * (billows_at(billows, place * float(FINER)) - BILLOWS_MEAN);
    }
    // No heap where there is no cloud, but thin rims are worn through.
    float share = min((heaps > 0.0 ? 0.0 : 0.3) + 4.0 * thick, 1.0);
    return thick + heaps * share * (0.4 + 0.6 * up);
}
#endif
