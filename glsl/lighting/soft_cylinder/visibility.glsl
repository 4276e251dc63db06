// lighting/soft_cylinder/visibility.glsl -- how much of a cylinder from the texel towards the sun the land leaves free: never more than half.
//
//   gives    visibility: the visible part of the sun, 0..1/2
//   needs    lighting/daylight_reading.glsl, lighting/walk.glsl; the land's tops and range as inputs
//   units    without unit; the cylinder's radius is measured upright
//   source   Belaiche 2010, section 4.4.1, eq. 4.3
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// The thesis's first attempt, kept because it fails, as the thesis shows in figures 4.4 and 4.5.
// The cylinder is as wide at its beginning as anywhere. So the texel's own ground hides its lower
// half, ((HL + r) - H) / 2r being 1/2 where HL is H; and neighbours no higher than the radius hide more.
//
// The radius is in the thesis's grey levels, of which there are 255 from height 0 to height 1.
#include "lighting/daylight_reading.glsl"
#include "lighting/walk.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;                //! input
uniform sampler2D tops;                  //! input
uniform sampler2D range;                 //! input
uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform float radius = 0.5;              //! slider(0, 64) step(0.1) group("Cylinder") unit("grey levels") Half of the cylinder's width; 255 grey levels are the height from 0 to 1
uniform float stride = 1.0;              //! slider(0.25, 4) step(0.25) group("March") unit("texels") Length of a step, along the axis that the ray follows more. Long steps jump over ridges
uniform int reading = 0;                 //! menu("interpolated", "cut down") group("March") Heights between texels, or of the texel that a place is cut down to, as in the thesis

// The free part of the cylinder over a walk of so many steps; `wide` is its radius in metres.
float seen(Walk walk, int count, float wide, bool on_lines) {
    float part = 0.5;
    int k = 1;
    while (k <= count) {
        int to;
        k = next_near(tops, walk, k, count, 0.0, walk.climb, relief, to);
        for (; k < to; k++) {
            float land = height_at_step(height, walk, k, reading, on_lines) * relief;
            float clearance = walk.foot + float(k) * walk.climb - land;
            part = min(part, clamp(0.5 + clearance / max(2.0 * wide, 1e-20), 0.0, 1.0));
            if (part == 0.0) return 0.0;
        }
    }
    return part;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    vec2 place = place_on(grid, texel, size);
    float wide = radius / 255.0 * relief;
    Walk walk = walk_from(place, height_at(height, place) * relief, light, grid, spacing_of(grid, extent), stride, size == grid);
    // The beginning leaves a half: only land over the cylinder's middle takes more.
    int count = steps_below(walk, walk.climb, texelFetch(range, ivec2(0), 0).g * relief);
    // Two loops, of which one has no steps: software renderers take both ways of an if inside one.
    return walk.on_lines ? seen(walk, walk.on_lines ? count : 0, wide, true) : seen(walk, walk.on_lines ? 0 : count, wide, false);
}
