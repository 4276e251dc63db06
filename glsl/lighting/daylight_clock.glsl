// lighting/daylight_clock.glsl -- hours that pass as time goes on, for lighting/daylight.
//
//   gives    elapsed: hours
//   needs    the time
//   units    hours; hours a second
//   source   none
//   tested   tests/glsl/test_daylight.py: the sun moves with the time, and without a clock stays
//            still
//
// It is a pass of its own because what names the time runs for every picture, and all that
// reads it as well.
#pragma kernel(output = "elapsed:r32f")

uniform float pace = 0.25;  //! slider(-24, 24) step(0.05) unit("h/s") Hours that pass in a second

float kernel(ivec2 texel) {
    return pace * time;
}
