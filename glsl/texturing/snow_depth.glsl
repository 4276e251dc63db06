// texturing/snow_depth.glsl -- how deep snow lies: by height and season, slope, wind and hollows.
//
//   gives    snow_depth
//   needs    terrain/shelter.glsl, lighting/daylight_date.glsl; a height; a daylight for the day
//   units    metres
//   source   drift: Winstral, Elder and Davis 2002 (terrain/shelter.glsl); slopes shed snow from
//            about 35 degrees on: Bernhardt and Schulz 2010, "SnowSlide: A simple routine for
//            calculating gravitational snow transport" (Geophysical Research Letters 37); the
//            season as a cosine: made here
//   tested   tests/glsl/test_near.py: monotone in height and slope, deeper in the lee
//
// texturing/snow_cover says where snow lies; this how deep, so that what stands out of it shows.
#include "lighting/daylight_date.glsl"
#include "terrain/shelter.glsl"
#pragma kernel(output = "snow_depth:r16f")

uniform sampler2D height;    //! input
uniform sampler2D daylight;  //! input("black")

uniform float line = 1500.0;  //! slider(-500, 9000) unit("m")
                              //! The snow line of spring and autumn, above sea level
uniform float season = 900.0; //! slider(0, 4000) unit("m")
                              //! How much lower it is in February, and higher in August
uniform float more = 0.002;   //! log_slider(0.0001, 0.1) unit("m")
                              //! Snow per metre above the line
uniform float maximum = 2.0;  //! log_slider(0.01, 20) unit("m") Depth on level ground at most
uniform vec2 holds = vec2(32.0, 52.0);  //! slider(0, 90) step(0.5) unit("degrees")
                              //! parts("from", "none") Slopes between which it slides off
uniform float wind = 270.0;   //! angle(0, 360) Where the wind comes from
uniform float drift = 0.6;    //! slider(0, 1) step(0.01) How much wind carries into the lee
uniform float wind_distance = 300.0;  //! log_slider(1, 20000) unit("m")
                              //! How far upwind it looks for shelter
#include "trees/parameters/season.glsl"

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    float level = base_elevation + relief * height_at(height, place);
    float today = day_of_year(wired_daylight, daylight, day);
    // The snow is lowest in the middle of February, six weeks after the shortest day.
    float lowered = season * cos(6.2831853 * (today - 46.0) / 365.25);
    float fallen = clamp(more * (level - line + lowered), 0.0, maximum);
    vec2 slope = relief * slope_at(height, place, metres, CENTRAL_DIFFERENCES);
    float incline = degrees(atan(length(slope)));
    float holding = 1.0 - smoothstep(holds.x, max(holds.y, holds.x + 0.1), incline);
    float blown = shelter_at(height, place, metres, relief, wind, wind_distance);
    float depth = fallen * holding * max(1.0 + drift * blown, 0.0);
    return depth >= 0.0 ? depth : 0.0;
}
