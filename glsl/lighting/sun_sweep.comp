// lighting/sun_sweep.comp -- the horizon towards the sun, each band of the terrain swept once.
//
//   gives    horizon: tangents of the horizon's elevation, one a texel of the terrain
//   needs    lighting/daylight_reading.glsl, lighting/sun_sweep/band.glsl, maths/land.glsl
//   units    rise over run; -10000 where no terrain stands towards the sun
//   source   see lighting/sun_sweep/band.glsl
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//   agrees   exactly: it does what the kernel beside it does, less often
//
// A thread has a band. Bands that begin beside the terrain enter it later.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_sweep/band.glsl"
#include "maths/land.glsl"
#pragma compute(groups = "(size.x + size.y + 63) // 64, 1", local = "64, 1", \
                buffers = "horizon:float:size.x * size.y", overwrites = "horizon", \
                aligned = "4", agrees = "exact")

uniform sampler2D height;              //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sun_shape.glsl"

void main() {
    ivec2 grid = textureSize(height, 0);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    int thread = int(gl_GlobalInvocationID.x);
    if (size != grid) {
        for (int i = thread; i < size.x * size.y; i += 64 * int(gl_NumWorkGroups.x)) {
            horizon[i] = NO_HORIZON;
        }
    }
    Lines lines = lines_towards(grid, light, spacing_of(grid, extent));
    vec4 climb = slopes_around(lines, light, shape, spread);
    Band band = band_at(thread - 1 - max(moved(lines, lines.rows - 1), 0));
    int end = size == grid ? last_row(lines, band.line) : 0;
    for (int row = first_row(lines, band.line); row < end; row++) {
        enter_row(band, height, lines, row, climb, relief);
        int across = texel_of(band);
        float tangent = horizon_of(band, lines);
        ivec2 texel = texel_on(lines, row, across);
        if (across >= 0 && across <= lines.last) horizon[texel.y * size.x + texel.x] = tangent;
    }
}
