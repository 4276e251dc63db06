// lighting/daylight/place.glsl -- the sun's place in the sky, by place and hour or free.
//
//   gives    place: azimuth and elevation, as seen through the air; date: days from the first of
//            January, whole, below 365, the latitude, how far the sky of stars has turned
//   needs    lighting/sun_position.glsl; the hours that have elapsed since the hour that is set,
//            if any
//   units    degrees, azimuth clockwise from north; hours
//   source   see lighting/sun_position.glsl
//   tested   tests/glsl/test_daylight.py, against lighting/sun_position.glsl over days and zones
#include "lighting/sun_position.glsl"
#pragma kernel(output = "place:rg32f, date:rgba32f")

uniform int position = 0;             //! menu("date and hour", "free") group("Sun")
                                      //! Whether the sun follows place, date and hour
uniform vec2 sun = vec2(135.0, 25.0); //! direction group("Sun") Where it is if it is free
uniform float latitude = 34.85;       //! slider(-90, 90) step(0.05) unit("degrees") group("Place")
                                      //! North of the equator; Biskra's by default
uniform float longitude = 5.73;       //! slider(-180, 180) step(0.05) unit("degrees")
                                      //! group("Place")
                                      //! East of Greenwich
uniform int year = 2025;              //! slider(1950, 2050) group("Date")
                                      //! The year; it moves the sun by less than its width
uniform int day = 120;                //! slider(1, 366) group("Date")
                                      //! Day of the year, 1 for the first of January
uniform float hour = 9.0;             //! slider(0, 24) step(0.05) unit("h") group("Date")
                                      //! Hour of the day
uniform int clock = 0;                //! menu("sun", "zone") group("Date")
                                      //! The sun's own hour, 12 as it crosses the meridian, or a
                                      //! time zone's
uniform float zone = 0.0;             //! slider(-12, 14) step(0.25) unit("h") group("Date")
                                      //! How far that zone's clocks are ahead of universal time
uniform sampler2D elapsed;            //! input("black")

void kernel(ivec2 texel, out vec2 place, out vec4 date) {
    float hours = hour + texelFetch(elapsed, ivec2(0), 0).r;
    int days = int(floor(hours / 24.0));
    hours -= 24.0 * float(days);
    vec2 here = vec2(latitude, longitude);
    vec2 by_sun = sun_position_solar(here, year, day + days, hours);
    vec2 by_zone = sun_position(here, year, day + days, hours - zone);
    place = position == 1 ? sun : clock == 1 ? by_zone : by_sun;
    float turned = clock == 1 ? sidereal_angle(longitude, year, day + days, hours - zone)
            : sidereal_angle_solar(longitude, year, day + days, hours);
    date = vec4(mod(float(day - 1 + days), 365.0), latitude, mod(turned, 360.0), 0.0);
}
