// view/sky_behind.glsl -- the sky, where nothing has been drawn yet.
//
//   gives    frame, linear light, over an earlier draw
//   needs    view/sky_seen.glsl; the camera; daylight if there is any
//   units    colours linear
//   source   as view/sky.glsl, whose picture it is
//   tested   tests/glsl/test_view_ground.py, against view/sky
//
// In the place of view/sky where the terrain is drawn first: it costs what is seen of it.
#include "view/sky_seen.glsl"
#pragma draw(mesh = "sheet", output = "frame:rgba16f", samples = 1)

uniform sampler2D daylight;  //! input("black")
uniform int sky = 0;         //! menu("colours", "daylight") group("Sky")
                             //! What is behind the terrain: the colours below, or the sky of
                             //! lighting/daylight if the sketch has it
uniform vec3 zenith = vec3(0.105, 0.245, 0.56);  //! colour group("Sky") Straight overhead
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);   //! colour group("Sky") Level with the eye
uniform vec3 nadir = vec3(0.125, 0.19, 0.27);     //! colour group("Sky")
                                                  //! Straight underfoot, where there is no
                                                  //! terrain; under daylight, what it is in white
                                                  //! light

// Just before the far plane, so that it is nearer than what a depth begins with.
const float BEHIND = 1.0 - 2.4e-7;

vec4 vertex(vec3 corner, out vec2 pixel) {
    pixel = corner.xy * vec2(size);
    return vec4(corner.xy * 2.0 - 1.0, BEHIND, 1.0);
}

vec4 fragment(vec2 pixel) {
    bool by_day = sky == 1 && wired_daylight;
    SkyView view = SkyView(world_from_clip, eye, vec2(size),
                           0.001 * max(base_elevation + eye.z, 0.0));
    vec3 seen = sky_seen(view, pixel, by_day, daylight, zenith, horizon, nadir);
    return vec4(seen, 1.0);
}
