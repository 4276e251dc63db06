// lighting/sun_sweep/plain.glsl -- one texel's horizon as the sweep finds it.
//
//   gives    swept_horizon
//   needs    lighting/sun_sweep/band.glsl; the texture of heights comes as an argument
//   units    as there
//   source   as there
//   tested   tests/glsl/test_fast_variants.py, against the compute variants of those who use it
#ifndef LIGHTING_SUN_SWEEP_PLAIN
#define LIGHTING_SUN_SWEEP_PLAIN
#include "lighting/sun_sweep/band.glsl"

float swept_horizon(sampler2D field, ivec2 texel, Lines lines, vec4 climb, float metres) {
    ivec2 turned = lines.along_x ? texel : texel.yx;
    int row = lines.from_high ? lines.rows - 1 - turned.x : turned.x;
    int before = moved_part(lines, row) > 0.0 ? 1 : 0;
    Band band = band_at(turned.y - before - moved(lines, row));
    for (int k = first_row(lines, band.line); k <= row; k++) {
        enter_row(band, field, lines, k, climb, metres);
    }
    return horizon_of(band, lines);
}
#endif
