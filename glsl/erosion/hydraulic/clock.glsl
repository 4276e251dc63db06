// erosion/hydraulic/clock.glsl -- how long a step is, for the same terrain at any size.
//
//   gives    step_hours
//   needs    nothing: a pure function
//   units    hours; texels
//   source   derived here from the wave's speed in Mei, Decaudin and Hu 2007
//   tested   tests/glsl/test_hydraulic.py, by terrains of several sizes
//
// A wave goes the same share of a texel in a step, whatever the texel's size. So that it goes as
// far in an hour, a step is as long as a texel is wide: an hour where the longer side has 257.
// Rates an hour times this are rates a step.
#ifndef EROSION_HYDRAULIC_CLOCK
#define EROSION_HYDRAULIC_CLOCK

float step_hours(ivec2 grid) {
    return 256.0 / float(max(max(grid.x, grid.y) - 1, 1));
}
#endif
