// erosion/hydraulic/start.glsl -- dry rock in the first rain, and what each place gets every step.
//
//   gives    state: red the bed, green the water on it, blue what the water carries, alpha the
//            mean flow; flux, none yet; site: red the water that a step brings, green the share
//            of what could still be carried that a step takes up
//   needs    erosion/hydraulic/clock.glsl, maths/land.glsl; a height
//   units    metres, the load as metres of rock, the flow as metres of water a step; the input
//            `hardness` 1 for the reference rock, 2 for one that wears half as fast
//   source   Mei, Decaudin and Hu 2007, "Fast Hydraulic Erosion Simulation and Visualization on
//            GPU", Pacific Graphics, section 3.2.1: rain, and sources of rivers
//   tested   tests/glsl/test_hydraulic.py, by the water's budget
#include "erosion/hydraulic/clock.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "state:rgba32f, flux:rgba32f, site:rg32f")

uniform sampler2D height;    //! input
uniform sampler2D rain_map;  //! input("white")
uniform sampler2D hardness;  //! input("white")

uniform float rain = 0.05;   //! slider(0, 1) step(0.001) unit("m/h")
                             //! Rain, times the input `rain` where it is wired
uniform float spring = 0.0;  //! slider(0, 100) step(0.1) unit("million m³/h") group("River")
                             //! Water of a river that rises here or comes from elsewhere
uniform vec2 spring_at = vec2(0.5, 0.5);  //! point group("River") Where it rises
uniform float spring_width = 400.0;       //! log_slider(1, 10000) unit("m") group("River")
                                          //! How wide its source is
uniform float wear = 0.3;    //! slider(0, 2) step(0.01) unit("1/h")
                             //! How fast water takes up what it can carry, of rock of hardness 1

// Metres of water an hour from a source that thins out towards its rim: the integral of
// (1 - r^2)^2 over the unit circle is pi / 3.
float river(vec2 place) {
    float radius = max(0.5 * spring_width, 2.0 * max(spacing.x, spacing.y));
    vec2 offset = (place - spring_at * extent) / radius;
    float near = max(1.0 - dot(offset, offset), 0.0);
    return spring * 1e6 * 3.0 / (3.14159265 * radius * radius) * near * near;
}

float at(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    return texelFetch(field, ivec2(place_on(grid, texel, size) + 0.5), 0).r;
}

void kernel(ivec2 texel, out vec4 state, out vec4 flux, out vec2 site) {
    float supply = max(rain * at(rain_map, texel), 0.0);
    if (spring > 0.0) supply += river(share_of_texel(texel, size) * extent);
    if (2 * texel.x > size.x) supply = 0.0;
    // In whole 65536ths of a metre: what is below the last bit of a lake's depth would be lost,
    // and the same every step.
    supply = floor(supply * step_hours(size) * 65536.0 + 0.5) / 65536.0;
    flux = vec4(0.0);
    state = vec4(relief * at(height, texel), supply, 0.0, 0.0);
    site = vec2(supply, 1.0 - exp(-wear * step_hours(size) / max(at(hardness, texel), 1e-3)));
}
