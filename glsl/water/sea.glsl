// water/sea.glsl -- the sea, or a flooded valley: water of one level everywhere.
//
//   gives    water, as water/sheet_reading has it: level, no current, OPEN
//   needs    water/sheet_reading.glsl
//   units    metres
//   source   none: a number
//   tested   tests/glsl/test_water_sheet.py
//
// All its texels are the same, so one is enough: `size = 1`.
#include "water/sheet_reading.glsl"
#pragma kernel(output = "water:rgba32f", level = "sea_level")

uniform float sea_level = 0.0;  //! slider(-500, 9000) step(0.1) unit("m") Height of its surface,
                                //! as elevations are counted

vec4 kernel(ivec2 texel) {
    return vec4(sea_level - base_elevation, 0.0, 0.0, OPEN);
}
