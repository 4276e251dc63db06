// clouds/slice/density.glsl -- a slice through heaps of cloud over hills, by noise.
//
//   gives    density: of the cloud, 0..1, and in green 1 in the ground
//   needs    noise/gradient.glsl
//   units    the picture is a slice of `extent` metres, its foot at sea level
//   source   noise over a threshold that rises with height: Schneider 2015, "The Real-Time
//            Volumetric Cloudscapes of Horizon Zero Dawn" (SIGGRAPH course), in two dimensions
//   tested   tests/glsl/test_lesson_outdoors.py: no cloud below the base nor over the top
//
// Two dimensions, so that a picture can show all of it. The clouds of a scene are those of
// clouds/field.
#include "noise/gradient.glsl"
#pragma kernel(output = "density:rg16f")

uniform float cover = 0.75;    //! slider(0, 1) step(0.01) How much of the sky has clouds
uniform float base = 1300.0;   //! slider(500, 3000) step(10) unit("m") Their foot
uniform float tall = 1600.0;   //! slider(200, 3000) step(10) unit("m") The tallest
uniform int octaves = 5;       //! slider(1, 7) Of the noise
uniform uint seed = 4u;        //! slider(0, 9999) Which clouds

const uint SALT = 0xb3bde8a1u;  // CRC-32 of "lessons/cloud_slice"

float noise(vec2 place) {
    float total = 0.0;
    for (int k = 0; k < octaves; k++) {
        total += perlin(place * exp2(float(k)), seed + SALT + uint(k)).x * exp2(-float(k));
    }
    return total;
}

vec2 kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing;
    float hills = 260.0 + 220.0 * noise(vec2(place.x / 2600.0, 0.5));
    // anchor: density
    float up = (place.y - base) / tall;                  // 0 at their foot, 1 at the top
    float wanted = mix(0.9, -0.5, cover) + 1.1 * up;     // the higher, the less cloud
    float density = clamp(5.0 * (noise(place / 1300.0) - wanted), 0.0, 1.0);
    density *= smoothstep(0.0, 0.06, up) * step(up, 1.0);
    // end: density
    return vec2(density, step(place.y, hills));
}
