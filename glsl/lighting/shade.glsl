// lighting/shade.glsl -- light from the sun's visible part and from the sky: what every method of shadows ends with.
//
//   gives    light: red, green, blue; alpha the visible part of the sun, 0 where the surface is turned away from it
//   needs    lighting/daylight_reading.glsl, lighting/sun.glsl, terrain/heightfield.glsl; unwired, the sun and the sky are whole
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, sections 3.5.3 and 4.4 (eqs 4.1 and 4.2)
//   tested   tests/glsl/test_lighting.py, against NumPy
//
// light = sun colour gain V max(0, N·L) + sky colour ambient F. V and F may have other sizes
// than the light: they are read where the texel stands. F has three channels, since ground that
// throws light back has a colour.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                //! input
uniform sampler2D visibility;            //! input("white")
uniform sampler2D sky_factor;            //! input("white")
uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform vec3 sun_colour = vec3(1.0);     //! colour group("Sun") Colour of the sun's light
uniform float gain = 2.0;                //! slider(0, 4) step(0.05) group("Sun") The sun's light is multiplied by it
uniform vec3 sky_colour = vec3(1.0);     //! colour group("Sky") Colour of the light from everywhere
uniform float ambient = 0.0;             //! slider(0, 1) step(0.01) group("Sky") Light from everywhere, in shadow too
uniform int normal = 0;                  //! menu("central differences", "one triangle") How the slope is found; the thesis takes one triangle, to one side

// A texture where a texel of the light stands.
vec3 read_at(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    vec2 place = place_on(grid, texel, size);
    ivec2 low = ivec2(place);
    vec2 part = place - vec2(low);
    // Loops that ask at their end, as in slope_at: on a texel this is one turn.
    ivec2 turns = ivec2(part.x > 0.0 ? 2 : 1, part.y > 0.0 ? 2 : 1);
    vec3 total = vec3(0.0);
    int y = 0;
    do {
        int x = 0;
        do {
            float weight = (x == 1 ? part.x : 1.0 - part.x) * (y == 1 ? part.y : 1.0 - part.y);
            total += weight * texelFetch(field, low + ivec2(x, y), 0).rgb;
            x++;
        } while (x < turns.x);
        y++;
    } while (y < turns.y);
    return total;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 slope = relief * (matches_height ? slope_of_node(height, texel, metres, normal) : slope_at(height, place_on(grid, texel, size), metres, normal));
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    vec3 light = from.direction;
    float received = max(0.0, dot(normal_of_slope(slope), light));
    // Where nothing is wired to say so, a sun below the horizon is hidden.
    if (light.z < 0.0 && !wired_visibility) received = 0.0;
    float visible = matches_visibility ? texelFetch(visibility, texel, 0).r : wired_visibility ? read_at(visibility, texel).r : 1.0;
    if (received <= 0.0) visible = 0.0;
    vec3 sky = from.sky * ambient;
    if (wired_sky_factor) sky *= read_at(sky_factor, texel);
    return vec4(from.sun * (visible * gain * received) + sky, visible);
}
