// water/wave_table.glsl -- the waves of a moment: the same for all pixels, so worked out once.
//
//   gives    waves: row 0 those of the wind, row 1 those of running water
//   needs    water/waves.glsl
//   units    as of wave_row there
//   source   see there
//   tested   tests/glsl/test_water_surface.py: they move as waves on deep water do
#include "water/waves.glsl"
#pragma kernel(output = "waves:rgba32f")

#include "water/parameters/wind.glsl"

vec4 kernel(ivec2 texel) {
    vec2 towards = vec2(sin(radians(wind_to)), cos(radians(wind_to)));
    return wave_row(texel.y == 0 ? sea_of(wind, fetch, towards) : river_of(1.0, 0.0), texel.x,
                    time);
}
