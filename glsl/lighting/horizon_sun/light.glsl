// lighting/horizon_sun/light.glsl -- light of a sun whose horizons are known, and of the sky.
//
//   gives    light: red, green, blue; alpha the visible part of the sun, 0 where the surface is
//            turned away from it; visibility: the part of the sun that is over the horizon
//   needs    lighting/daylight_reading.glsl, lighting/horizon_sun/arc.glsl,
//            terrain/maps.glsl, lighting/sun.glsl, terrain/heightfield.glsl; horizons, normals,
//            the table of sunlight, and where the sun is
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, section 3.4, eqs 3.3, 3.7 and 3.8
//   tested   tests/glsl/test_analytic.py, against float64
//
// All that is done when the sun moves: a few fetches a texel, and no look at the terrain. Eq. 3.3
// has no 1/pi: its sunlight is already divided by it. The thesis looks up no texel whose light
// stays the same; here all are looked up at once.
#include "lighting/daylight_reading.glsl"
#include "lighting/horizon_sun/arc.glsl"
#include "terrain/maps.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "light:rgba16f, visibility:r32f")

uniform sampler2D height;                //! input
uniform sampler2D between;               //! input
uniform sampler2D facing;                //! input
uniform sampler2D table;                 //! input
uniform sampler2D stand;                 //! input
uniform sampler2D sky_factor;            //! input("white")
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
uniform float clouds = 0.0;              //! slider(0, 1) step(0.01) group("Sun")
                                         //! How much of the sun's light clouds keep back
uniform int sun_term = 0;                //! menu("table", "each texel") group("Sun")
                                         //! Sunlight from a table of normals, or worked out for
                                         //! each texel
#include "lighting/parameters/normal.glsl"

vec4 received_at(ivec2 texel) {
    if (sun_term == 0) {
        return texelFetch(table, ivec2(texelFetch(facing, texel, 0).rg * 255.0 + 0.5), 0);
    }
    Sunlight given = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, vec3(0.0));
    ivec2 grid = textureSize(height, 0);
    vec2 slope = relief * slope_at(height, place_on(grid, texel, size), spacing_of(grid, extent),
                                   normal);
    float received = max(dot(normal_of_slope(slope), given.direction), 0.0);
    return vec4(given.sun * (gain * (1.0 - clouds) * received), received > 0.0 ? 1.0 : 0.0);
}

void kernel(ivec2 texel, out vec4 light, out float visibility) {
    float horizon = dot(texelFetch(between, texel, 0).rg, texelFetch(stand, ivec2(0), 0).zw);
    vec4 over = texelFetch(stand, ivec2(1, 0), 0);
    visibility = disc_seen(over.a, horizon);
    vec4 received = received_at(texel);
    vec3 sky = over.rgb;
    if (wired_sky_factor) {
        sky *= (matches_sky_factor ? texelFetch(sky_factor, texel, 0)
                : map_at(sky_factor, texel, size)).rgb;
    }
    light = vec4(received.rgb * visibility + sky, received.a * visibility);
}
