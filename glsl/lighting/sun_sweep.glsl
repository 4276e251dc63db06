// lighting/sun_sweep.glsl -- the horizon towards the sun, by a sweep along parallel lines.
//
//   gives    horizon: tangents of the horizon's elevation, one a texel of the terrain
//   needs    lighting/daylight_reading.glsl, lighting/sun_sweep/band.glsl, maths/land.glsl
//   units    rise over run; -10000 where no terrain stands towards the sun
//   source   see lighting/sun_sweep/band.glsl
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// What the methods of shadow ask of it is in their own kernels; this one is for a look at the
// horizon itself. It is found well where the sun could stand in it: `shape` and `spread` say how
// wide that is. It has the terrain's size; at any other, which those give it who do not want it,
// it knows of no horizon. This text sweeps a texel's band from its beginning, for every texel
// anew; the compute variant sweeps each band once, so that a terrain costs as many steps as it has
// texels. Without compute shaders the methods of shadow march: that is twenty times as fast as
// this text.
//
// Against a march: hard shadows differ on at most 0.6 % of the texels of the terrains that ship,
// at a sun of 5 to 25 degrees, and at a shadow's edge; a soft part by 0.006 on average, by 0.02
// for a cone as wide as the night's. Along axes and diagonals they are the same but for rounding.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_sweep/band.glsl"
#include "lighting/sun_sweep/plain.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "horizon:r32f")

uniform sampler2D height;              //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sun_shape.glsl"

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    Lines lines = lines_towards(grid, light, spacing_of(grid, extent));
    if (size != grid) return NO_HORIZON;
    return swept_horizon(height, texel, lines, slopes_around(lines, light, shape, spread), relief);
}
