// lighting/ray_cast/visibility.glsl -- whether a walk towards the sun meets land: 1 where it does not, 0 where it does.
//
//   gives    visibility: the visible part of the sun, 0 or 1
//   needs    lighting/daylight_reading.glsl, lighting/walk.glsl; the land's tops and range, or its swept horizon, as inputs
//   units    without unit
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_lighting.py and tests/glsl/test_shadows.py, against marches in NumPy and walls' shadows in metres
//
// From each texel's own height a ray goes to the sun, a step at a time. Land above the ray
// hides the sun; a ray above the highest height, or off the land, is free.
//
// Mended: the thesis reads the texel that the ray's place is cut down to, which moves every
// shadow half a texel to the south-west; here heights are interpolated between texels' centres,
// and the land ends at the last one. Its way remains a choice, for comparison.
#include "lighting/daylight_reading.glsl"
#include "lighting/walk.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;                //! input
uniform sampler2D tops;                  //! input
uniform sampler2D range;                 //! input
uniform sampler2D horizon;               //! input
uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform int form = 0;                    //! menu("march", "sweep") group("March") Walk from every texel, or sweep the land once along lines, which is faster and nearly the same; without compute shaders the sweep is slow, and a march is made instead
uniform float stride = 1.0;              //! slider(0.25, 4) step(0.25) group("March") unit("texels") Length of a step, along the axis that the ray follows more. Long steps jump over ridges
uniform int reading = 0;                 //! menu("interpolated", "cut down") group("March") Heights between texels, or of the texel that a place is cut down to, as in the thesis

// 1 if a walk of so many steps meets no land over its ray, else 0.
float seen(Walk walk, int count, bool on_lines) {
    int k = 1;
    while (k <= count) {
        int to;
        k = next_near(tops, walk, k, count, 0.0, walk.climb, relief, to);
        // anchor: march
        for (; k < to; k++) {
            float land = height_at_step(height, walk, k, reading, on_lines) * relief;
            if (land > walk.foot + float(k) * walk.climb) return 0.0;
        }
        // end: march
    }
    return 1.0;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    // A horizon of one texel was not swept: there are no compute shaders.
    bool swept = form == 1 && textureSize(horizon, 0).x > 1;
    if (swept) return texelFetch(horizon, texel, 0).r * length(light.xy) > light.z ? 0.0 : 1.0;
    vec2 place = place_on(grid, texel, size);
    Walk walk = walk_from(place, height_at(height, place) * relief, light, grid, metres, stride, size == grid);
    int count = steps_below(walk, walk.climb, texelFetch(range, ivec2(0), 0).g * relief);
    // Two loops, of which one has no steps: software renderers take both ways of an if inside one.
    return walk.on_lines ? seen(walk, walk.on_lines ? count : 0, true) : seen(walk, walk.on_lines ? 0 : count, false);
}
