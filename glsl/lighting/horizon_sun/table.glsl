// lighting/horizon_sun/table.glsl -- the sun's light on a surface by where its normal points, for all normals at once.
//
//   gives    table: red, green, blue; alpha 1 where the surface faces the sun
//   needs    lighting/daylight_reading.glsl, lighting/horizon_sun/arc.glsl
//   units    light without unit; texel (i, j) is the normal with x = (i - 128) / 127, y = (j - 128) / 127
//   source   Belaiche 2010, section 3.4, eq. 3.7
//   tested   tests/glsl/test_analytic.py, against float64
//
// 256 x 256 normals, a sixteenth of a light map of 1025 x 1025. Clouds dim the sun alone.
#include "lighting/daylight_reading.glsl"
#include "lighting/horizon_sun/arc.glsl"
#pragma kernel(output = "table:rgba16f")

uniform sampler2D daylight;              //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform vec3 sun_colour = vec3(1.0);     //! colour group("Sun") Colour of the sun's light
uniform float gain = 2.0;                //! slider(0, 4) step(0.05) group("Sun") The sun's light is multiplied by it
uniform float clouds = 0.0;              //! slider(0, 1) step(0.01) group("Sun") How much of the sun's light clouds keep back
uniform int measured = 0;                //! menu("on its arc", "eight directions") group("Sun") A sun that keeps to its arc needs two horizons; with eight it may stand anywhere, as that of a daylight always does
uniform float arc = -360.0;              //! angle follows("sun", "measured", "on its arc") group("Sun") Azimuth of the first horizon, and of the sun's arc, which goes on through the zenith. Unless set, the arc is under the sun, and its horizons are worked out anew when the sun's azimuth changes

vec4 kernel(ivec2 texel) {
    vec2 level = (vec2(texel) - 128.0) / 127.0;
    vec3 normal = vec3(level, sqrt(max(1.0 - dot(level, level), 0.0)));
    Sunlight given = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, vec3(0.0));
    float received = max(dot(normal, on_arc(given.direction, arc, directions_for(measured, wired_daylight))), 0.0);
    return vec4(given.sun * (gain * (1.0 - clouds) * received), received > 0.0 ? 1.0 : 0.0);
}
