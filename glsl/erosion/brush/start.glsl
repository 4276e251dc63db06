// erosion/brush/start.glsl -- the ground under a brush, the water of the stamp before, and rain.
//
//   gives    state: red the bed, green the water on it, blue what the water carries, alpha the
//            rock that has left with the water; runs, the flux; site as erosion/hydraulic takes
//            it: red the water that a step brings, green the share of what could still be carried
//            that a step takes up
//   needs    erosion/hydraulic/clock.glsl; all inputs have the size of this pass
//   units    metres, the load as metres of rock; the brush 0..1
//   source   erosion/hydraulic/start.glsl, with rain under the brush alone
//   tested   tests/glsl/test_erosion_brush.py, by the rock's budget
#include "erosion/hydraulic/clock.glsl"
#pragma kernel(output = "state:rgba32f, runs:rgba32f, site:rg32f")

uniform sampler2D height;  //! input
uniform sampler2D brush;   //! input("white")
uniform sampler2D water;   //! input("zero")
uniform sampler2D flux;    //! input("zero")

uniform float rain = 0.03; //! slider(0, 1) step(0.001) unit("m/h") Rain in the brush's middle
uniform float wear = 0.02;  //! slider(0, 2) step(0.001) unit("1/h")
                           //! How fast water takes up what it can carry

void kernel(ivec2 texel, out vec4 state, out vec4 runs, out vec2 site) {
    float hours = step_hours(size);
    float bed = relief * texelFetch(height, texel, 0).r;
    state = vec4(bed, texelFetch(water, texel, 0).rgb);
    runs = texelFetch(flux, texel, 0);
    site = vec2(rain * hours * texelFetch(brush, texel, 0).r, 1.0 - exp(-wear * hours));
}
