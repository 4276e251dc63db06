// lighting/sun_disc/visibility.glsl -- how much of the sun's disc stands over the land's horizon.
//
//   gives    visibility: the visible part of the disc's area, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/walk.glsl, lighting/sun_disc/area.glsl; the land's tops and range, or its swept horizon, as inputs
//   units    without unit; angles in degrees
//   source   beyond Belaiche 2010, whose eqs 3.8 and 4.3 fall evenly across the sun; the sun's
//            diameter from section 3.4
//   tested   tests/glsl/test_shadows.py, against quadrature of the disc over a horizon in NumPy
//
// The horizon is that of the sun's own azimuth, and is taken to be level across the disc: it is
// half a degree wide, and few ridges turn much in that. Beyond its edges the land is taken for a
// plain without end, so no horizon is below 0, and the sun sets evenly there.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_disc/area.glsl"
#include "lighting/walk.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;                //! input
uniform sampler2D tops;                  //! input
uniform sampler2D range;                 //! input
uniform sampler2D horizon;               //! input
uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform float diameter = 0.53;           //! slider(0.1, 20) step(0.01) group("Sun") unit("°") How wide the sun is
uniform int form = 0;                    //! menu("march", "sweep") group("March") Walk from every texel, or sweep the land once along lines, which is faster and nearly the same; without compute shaders the sweep is slow, and a march is made instead
uniform float stride = 1.0;              //! slider(0.25, 4) step(0.25) group("March") unit("texels") Length of a step, along the axis that the ray follows more. Long steps jump over ridges
uniform int reading = 0;                 //! menu("interpolated", "cut down") group("March") Heights between texels, or of the texel that a place is cut down to, as in the thesis

// The horizon's tangent over a walk of so many steps, from `least` on; `run` metres a step on the level.
// Above `most` the disc is hidden, however high the horizon is.
float horizon_over(Walk walk, int count, float run, float least, float most, bool on_lines) {
    float tangent = least;
    int k = 1;
    while (k <= count) {
        int to;
        k = next_near(tops, walk, k, count, 0.0, least * run, relief, to);
        for (; k < to; k++) {
            float land = height_at_step(height, walk, k, reading, on_lines) * relief;
            tangent = max(tangent, (land - walk.foot) / (float(k) * run));
            if (tangent > most) return tangent;
        }
    }
    return tangent;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    float elevation = sun_elevation(wired_daylight, daylight, sun);
    float level = length(light.xy);
    // A horizon of one texel was not swept: there are no compute shaders.
    bool swept = form == 1 && textureSize(horizon, 0).x > 1;
    if (swept) return disc_over(max(texelFetch(horizon, texel, 0).r, 0.0), elevation, diameter);
    vec2 place = place_on(grid, texel, size);
    Walk walk = walk_from(place, height_at(height, place) * relief, light, grid, metres, stride, size == grid);
    float run = walk.path * level;
    // Horizons below the disc and above it need not be told apart.
    float least = max(tangent_of(elevation - 0.5 * diameter), 0.0);
    float most = tangent_of(elevation + 0.5 * diameter);
    int count = steps_below(walk, least * run, texelFetch(range, ivec2(0), 0).g * relief);
    // Two loops, of which one has no steps: software renderers take both ways of an if inside one.
    float tangent = walk.on_lines
        ? horizon_over(walk, walk.on_lines ? count : 0, run, least, most, true)
        : horizon_over(walk, walk.on_lines ? 0 : count, run, least, most, false);
    return disc_over(tangent, elevation, diameter);
}
