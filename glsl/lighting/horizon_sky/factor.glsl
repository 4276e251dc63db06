// lighting/horizon_sky/factor.glsl -- how much of the sky's light a texel receives.
//
//   gives    factor: f, red, green, blue; k: K(p), the open sky's share alone
//   needs    lighting/horizon_sky/ground.glsl, terrain/maps.glsl,
//            lighting/horizons/open_sky.glsl, lighting/sun.glsl, terrain/heightfield.glsl;
//            horizons, and the table of sectors
//   units    shares of what an open sky gives level ground; the ground's colour linear
//   source   Belaiche 2010, section 3.4, eqs 3.9 to 3.13, after Stewart and Langer 1997
//   tested   tests/glsl/test_sky.py, against quadrature and closed forms
//
// f = K / (1 - C (1 - K)). Where no sky is seen, terrain is, and terrain that is seen is taken to
// be as bright as the place itself; C is the mean colour of the ground under the texel.
#include "lighting/horizon_sky/ground.glsl"
#include "terrain/maps.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "factor:rgba16f, k:r32f", relief = "shown")

uniform sampler2D height;     //! input
#include "lighting/parameters/eight_horizons.glsl"
uniform sampler2D sky;        //! input
uniform sampler2D table;      //! input
uniform sampler2D colour;     //! input("linear", "mipmap", "white")
uniform int summed = 0;       //! menu("by the table", "by the formula", "over all directions")
                              //! How K is found: of eight horizons by the table or the formula, or
                              //! of all that were measured
uniform vec3 ground = vec3(0.3);  //! colour The ground's mean colour, where no colour is wired
#include "lighting/parameters/normal.glsl"

// Between two places of a row of the table.
vec3 sector_of(int row, float tangent) {
    float place = tangent / (1.0 + tangent) * float(textureSize(table, 0).x - 1);
    int low = int(place);
    vec3 before = texelFetch(table, ivec2(low, row), 0).xyz;
    vec3 after = texelFetch(table, ivec2(min(low + 1, textureSize(table, 0).x - 1), row), 0).xyz;
    return before + (after - before) * (place - float(low));
}

float k_of_eight(vec4 before, vec4 after, vec2 slope) {
    vec3 sum = vec3(0.0);
    float total = 0.0;
    float shape = sector_shape(8);
    for (int i = 0; i < 8; i++) {
        vec2 towards = cos_sin_degrees(first - 45.0 * float(i)).yx;
        float tangent = i < 4 ? before[i & 3] : after[i & 3];
        if (summed == 0) {
            sum += sector_of(i, horizon_over_slope(tangent, slope, towards));
        } else {
            total += sky_of_sector(tangent, slope, towards, shape) / 8.0;
        }
    }
    return summed == 0 ? dot(sum, normal_of_slope(slope)) : total / sqrt(1.0 + dot(slope, slope));
}

void kernel(ivec2 texel, out vec4 factor, out float k) {
    ivec2 grid = textureSize(height, 0);
    vec2 slope = relief * slope_at(height, place_on(grid, texel, size), spacing_of(grid, extent),
                                   normal);
    if (summed == 2) {
        k = map_at(sky, texel, size).r;
    } else {
        k = k_of_eight(map_at(ahead, texel, size), map_at(behind, texel, size), slope);
    }
    k = clamp(k, 0.0, 1.0);
    factor = vec4(k * thrown_back(ground_under(wired_colour, colour, texel, size, ground), k),
                  1.0);
}
