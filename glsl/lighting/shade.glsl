// lighting/shade.glsl -- light from the sun's visible part and from the sky.
//
//   gives    light: red, green, blue; alpha the visible part of the sun, 0 where the surface is
//            turned away from it
//   needs    lighting/daylight_reading.glsl, lighting/sun.glsl, terrain/heightfield.glsl,
//            terrain/maps.glsl; unwired, the sun and the sky are whole; clouds over it by
//            clouds/shade, if there are any
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, sections 3.5.3 and 4.4 (eqs 4.1 and 4.2)
//   tested   tests/glsl/test_lighting.py, against NumPy
//
// It is what every method of shadows ends with.
//
// light = sun colour gain V max(0, N·L) + sky colour ambient F. V and F may have other sizes
// than the light: they are read where the texel is. F has three channels, since ground that
// throws light back has a colour.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                //! input
uniform sampler2D visibility;            //! input("white")
uniform sampler2D sky_factor;            //! input("white")
uniform sampler2D overhead;              //! input("white")
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "lighting/parameters/normal.glsl"

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 slope = relief * (matches_height ? slope_of_node(height, texel, metres, normal)
                           : slope_at(height, place_on(grid, texel, size), metres, normal));
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    vec3 light = from.direction;
    float received = max(0.0, dot(normal_of_slope(slope), light));
    // Where nothing is wired to say so, a sun below the horizon is hidden.
    if (light.z < 0.0 && !wired_visibility) received = 0.0;
    float visible = matches_visibility ? texelFetch(visibility, texel, 0).r : wired_visibility
            ? map_at(visibility, texel, size).r : 1.0;
    if (received <= 0.0) visible = 0.0;
    vec3 sky = from.sky * ambient;
    if (wired_sky_factor) sky *= map_at(sky_factor, texel, size).rgb;
    float beam = visible;
    if (wired_overhead) beam *= map_at(overhead, texel, size).r;
    return vec4(from.sun * (beam * gain * received) + sky, min(beam, 1.0));
}
