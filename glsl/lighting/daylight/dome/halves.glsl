// lighting/daylight/dome/halves.glsl -- both halves of the table of the sky at once.
//
//   gives    molecules, aerosol: the left and the right half of lighting/daylight/dome
//   needs    sky/dome.glsl, sky/sight.glsl, lighting/sun.glsl; the sun's place, the air and two
//            tables
//   units    as lighting/daylight/dome
//   source   see sky/sight.glsl
//   tested   tests/glsl/test_fast_variants.py, against lighting/daylight/dome, bit for bit
#include "lighting/sun.glsl"
#include "sky/dome.glsl"
#include "sky/sight.glsl"
#pragma kernel(output = "molecules:rgba32f, aerosol:rgba32f")

uniform sampler2D place;         //! input
uniform sampler2D columns;       //! input
uniform sampler2D bounced;       //! input
uniform sampler2D air;           //! input

void kernel(ivec2 texel, out vec4 molecules, out vec4 aerosol) {
    int rows = max(size.y / DOMES, 1);
    int table = min(texel.y / rows, DOMES - 1);
    float height = dome_height(table);
    vec2 share = vec2(texel.x, texel.y - table * rows) / vec2(max(ivec2(size.x, rows) - 1, 1));
    vec2 direction = dome_start(min(share, 1.0), height);
    vec3 sun = to_sun(texelFetch(place, ivec2(0), 0).rg);
    Air scatters = air_of(texelFetch(air, ivec2(0), 0).r);
    Sight seen = sight(columns, bounced, scatters, height, direction, sun);
    molecules = vec4(seen.molecules, 1.0);
    aerosol = vec4(seen.aerosol, 1.0);
}
