// lighting/sky_patches/parts.glsl -- the shares of five patches of the sky.
//
//   gives    low: K of the patches in the north, east, south and west; high: 1 / (1 - C (1 - K))
//            in red, green, blue, and K of the patch overhead
//   needs    lighting/horizon_sky/ground.glsl, terrain/maps.glsl,
//            lighting/horizons/open_sky.glsl, maths/angle.glsl, terrain/heightfield.glsl; eight
//            horizons, the first in the north
//   units    shares of what an open, even sky gives
//   source   Belaiche 2010, section 3.4, the patches and eq. 3.13
//   tested   tests/glsl/test_sky.py, against quadrature
//
// One is overhead, the others are low in the four quarters.
//
// f of a patch is K of the patch / (1 - C (1 - K)), where K below is that of all patches: what one
// patch lights is thrown back by terrain that all of them light.
#include "lighting/horizon_sky/ground.glsl"
#include "terrain/maps.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "maths/angle.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "low:rgba16f, high:rgba16f", relief = "shown")

uniform sampler2D height;     //! input
uniform sampler2D ahead;      //! input
uniform sampler2D behind;     //! input
uniform sampler2D colour;     //! input("linear", "mipmap", "white")
uniform float split = 40.0;   //! slider(1, 89) step(1) unit("°")
                              //! Elevation over which the sky is overhead
uniform vec3 ground = vec3(0.3);  //! colour The ground's mean colour, where no colour is wired
#include "lighting/parameters/normal.glsl"

// What half a sector gives over a horizon, half of it on either side of a direction.
float half_sector(float tangent, vec2 slope, vec2 towards) {
    vec2 open = above_horizon(tangent);
    return open.y - dot(slope, towards) * sector_shape(16) * open.x;
}

void kernel(ivec2 texel, out vec4 low, out vec4 high) {
    ivec2 grid = textureSize(height, 0);
    vec2 slope = relief * slope_at(height, place_on(grid, texel, size), spacing_of(grid, extent),
                                   normal);
    vec4 before = map_at(ahead, texel, size);
    vec4 after = map_at(behind, texel, size);
    vec2 edge = cos_sin_degrees(split);
    float parting = edge.y / edge.x;
    low = vec4(0.0);
    float overhead = 0.0;
    for (int i = 0; i < 16; i++) {
        // Two halves a sector: the quarters part in the middle of every other sector.
        int sector = i >> 1;
        float middle = 45.0 * float(sector) + ((i & 1) == 0 ? -11.25 : 11.25);
        float tangent = sector < 4 ? before[sector & 3] : after[sector & 3];
        tangent = horizon_over_slope(tangent, slope, cos_sin_degrees(-45.0 * float(sector)).yx);
        vec2 towards = cos_sin_degrees(-middle).yx;
        float above = half_sector(max(tangent, parting), slope, towards);
        float whole = half_sector(tangent, slope, towards);
        overhead += above;
        // North, west, south, east; here clockwise.
        int quarter = int(floor(middle / 90.0 + 0.5)) & 3;
        low += mix(vec4(0.0), vec4(whole - above), equal(ivec4(quarter), ivec4(0, 3, 2, 1)));
    }
    float scale = 1.0 / (16.0 * sqrt(1.0 + dot(slope, slope)));
    low = max(low * scale, 0.0);
    overhead = max(overhead * scale, 0.0);
    float k = min(overhead + dot(low, vec4(1.0)), 1.0);
    high = vec4(thrown_back(ground_under(wired_colour, colour, texel, size, ground), k), overhead);
}
