// view/sky.glsl -- what is behind the terrain.
//
//   gives    frame, linear light
//   needs    view/sky_seen.glsl; the camera; daylight if there is any
//   units    colours linear
//   source   the colours: none, a backdrop; the sky: see lighting/daylight/dome
//   tested   tests/glsl/test_view.py: the horizon's colour at the horizon, overhead's above; and
//            tests/glsl/test_daylight.py: the sky's colours and the sun's disc where they belong
//
// Three colours, or the sky of a daylight with the sun in it.
#include "view/sky_seen.glsl"
#pragma kernel(output = "frame:rgba16f")

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

vec4 kernel(ivec2 texel) {
    bool by_day = sky == 1 && wired_daylight;
    SkyView view = SkyView(world_from_clip, eye, vec2(size),
                           0.001 * max(base_elevation + eye.z, 0.0));
    vec3 seen = sky_seen(view, vec2(texel) + 0.5, by_day, daylight, zenith, horizon, nadir);
    return vec4(seen, 1.0);
}
