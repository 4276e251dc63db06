// lighting/soft_cone/visibility.glsl -- how much of a cone from the texel towards the sun the land leaves free.
//
//   gives    visibility: the visible part of the sun, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/walk.glsl; the land's tops and range, or its swept horizon, as inputs
//   units    without unit; the cone's radius is measured upright, in metres
//   source   Belaiche 2010, section 4.4.2, eq. 4.3
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// The thesis's own method. Around the ray to the sun grows a cone, from radius 0 at the texel.
// Where land stands at height H, the ray at HL and the cone's radius is r, the part
// ((HL + r) - H) / 2r of the cone is free; the least of all steps counts. Land over the whole
// cone hides the sun.
//
// delta_r is what the radius grows over one unit of path, heights and lengths in the same unit:
// the tangent of the cone's half angle, but for the radius being upright. The thesis adds it at
// every step, so that half the step makes the cone twice as wide: that remains a choice, and is
// the same at a stride of 1.
//
// In tangents of elevations the free part is 1/2 - (horizon - sun) cos(elevation) / (2 delta_r):
// so the sweep, which finds the horizon, gives it too.
#include "lighting/daylight_reading.glsl"
#include "lighting/walk.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;                //! input
uniform sampler2D tops;                  //! input
uniform sampler2D range;                 //! input
uniform sampler2D horizon;               //! input
uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform float delta_r = 0.01;            //! slider(0, 2) step(0.001) group("Cone") label("Δr") What the cone's radius grows over one unit of path. The real sun's is 0.0046
uniform int growth = 0;                  //! menu("per unit of path", "per step") group("Cone") What delta_r is counted by; the thesis counts steps, however long they are
uniform int form = 0;                    //! menu("march", "sweep") group("March") Walk from every texel, or sweep the land once along lines, which is faster and nearly the same; without compute shaders the sweep is slow, and a march is made instead
uniform float stride = 1.0;              //! slider(0.25, 4) step(0.25) group("March") unit("texels") Length of a step, along the axis that the ray follows more. Long steps jump over ridges
uniform int reach = 0;                   //! slider(0, 4096) group("March") unit("texels") In the march, land farther than this throws no shadow, and in the last quarter less of one; 0: all of it does
uniform int reading = 0;                 //! menu("interpolated", "cut down") group("March") Heights between texels, or of the texel that a place is cut down to, as in the thesis

// anchor: free-part
// The free part of a cone of that radius, whose middle is so high over the land.
float free_part(float clearance, float radius) {
    return clamp(0.5 + clearance / max(2.0 * radius, 1e-20), 0.0, 1.0);
}
// end: free-part

// The free part of the cone over a walk of so many steps, at most `part`.
float seen(Walk walk, int count, float part, float grows, bool on_lines) {
    float whole_reach = float(reach) / stride;
    float last_counted = reach > 0 ? 0.75 * whole_reach : 1e9;
    float fades = reach > 0 ? 4.0 / whole_reach : 0.0;
    int k = 1;
    while (k <= count) {
        int to;
        k = next_near(tops, walk, k, count, 0.0, walk.climb - grows, relief, to);
        // anchor: cone
        for (; k < to; k++) {
            float t = float(k);
            float land = height_at_step(height, walk, k, reading, on_lines) * relief;
            // For a part of a larger land: what its texture does not hold must not count for some texels only.
            float left_out = clamp((t - last_counted) * fades, 0.0, 1.0);
            float open = free_part(walk.foot + t * walk.climb - land, t * grows);
            part = min(part, open + (1.0 - open) * left_out);
            if (part == 0.0) return 0.0;
        }
        // end: cone
    }
    return part;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    // A horizon of one texel was not swept: there are no compute shaders.
    bool swept = form == 1 && textureSize(horizon, 0).x > 1;
    if (swept) return free_part(light.z - texelFetch(horizon, texel, 0).r * length(light.xy), delta_r);
    vec2 place = place_on(grid, texel, size);
    Walk walk = walk_from(place, height_at(height, place) * relief, light, grid, metres, stride, size == grid);
    float grows = delta_r * walk.path / (growth == 1 ? stride : 1.0);
    // With a delta_r over the sun's own climb the cone's lower side goes down, and the walk to the land's edge.
    int count = steps_below(walk, walk.climb - grows, texelFetch(range, ivec2(0), 0).g * relief);
    if (reach > 0) count = min(count, int(float(reach) / stride));
    // Under the zenith the cone stands over the texel itself, which only a very wide one notices.
    float whole = length(light.xy) < 1e-6 ? free_part(light.z, delta_r) : 1.0;
    // Two loops, of which one has no steps: software renderers take both ways of an if inside one.
    return walk.on_lines ? seen(walk, walk.on_lines ? count : 0, whole, grows, true) : seen(walk, walk.on_lines ? 0 : count, whole, grows, false);
}
