// lighting/sun_position.glsl -- where the sun is over a place on Earth, by day and hour.
//
//   gives    days_from_2000, sun_course, sun_over, refraction, sidereal_angle,
//            sidereal_angle_solar, sun_position, sun_position_solar
//   needs    maths/angle.glsl
//   units    degrees; latitude north and longitude east of Greenwich positive; hours from
//            midnight, of any number; azimuth clockwise from north; elevation of the disc's middle
//   source   National Oceanic and Atmospheric Administration, "Solar Calculation Details", after
//            Meeus 1998, "Astronomical Algorithms", chapters 25 and 28; its refraction by pieces
//   tested   tests/glsl/test_sun_position.py, against the Astronomical Almanac's formulas in
//            float64, and published examples
//
// Right to 0.02 degrees from 1950 to 2050 (and days are counted right from 1901 to 2099).
// A float holds a century of degrees only to the hundredth, so what turns by nearly a degree
// a day is taken as the days themselves, in whole circles, less what it falls short of them.
#ifndef LIGHTING_SUN_POSITION
#define LIGHTING_SUN_POSITION
#include "maths/angle.glsl"

// Days from the first of January 2000 to a day of a year; the first of January is day 1.
int days_from_2000(int year, int day) {
    int years = year - 2000;
    // Leap years since 2000; the shift rounds down for years before it, too.
    return 365 * years + ((years + 3) >> 2) + day - 1;
}

// An angle that was `start` at noon of the first day and falls short of a degree a day by `lag`.
float turned_since_2000(float start, float lag, int days, float part) {
    int rest = days - 360 * int(floor(float(days) / 360.0));
    return start + float(rest) + part - lag * (float(days) + part);
}

// The sine of the sun's declination, and how many degrees the sun is ahead of the mean one
// (the equation of time), so many days from 2000 and so many hours of universal time.
vec2 sun_course(int days, float hours) {
    float part = hours / 24.0 - 0.5;
    float centuries = (float(days) + part) / 36525.0;
    float longitude = turned_since_2000(280.46646, 0.01435264, days, part);  // of the mean sun
    float anomaly = turned_since_2000(357.52911, 0.01439972, days, part);
    float node = 125.04 - 1934.136 * centuries;
    float eccentricity = 0.016708634 - 0.000042037 * centuries;
    vec2 once = cos_sin_degrees(anomaly);
    vec2 twice = cos_sin_degrees(2.0 * anomaly);
    float centre = (1.914602 - 0.004817 * centuries) * once.y
            + (0.019993 - 0.000101 * centuries) * twice.y
                 + 0.000289 * cos_sin_degrees(3.0 * anomaly).y;
    vec2 nutation = cos_sin_degrees(node);
    float apparent = longitude + centre - 0.00569 - 0.00478 * nutation.y;
    float tilt = 23.4392911 - 0.0130042 * centuries + 0.00256 * nutation.x;
    vec2 tilted = cos_sin_degrees(tilt);
    float declination_sine = tilted.y * cos_sin_degrees(apparent).y;
    float half_tangent = tilted.y / (1.0 + tilted.x);
    float y = half_tangent * half_tangent;
    vec2 mean_twice = cos_sin_degrees(2.0 * longitude);
    float ahead = y * mean_twice.y - 2.0 * eccentricity * once.y
                + 4.0 * eccentricity * y * once.y * mean_twice.x
                - 0.5 * y * y * cos_sin_degrees(4.0 * longitude).y
                        - 1.25 * eccentricity * eccentricity * twice.y;
    return vec2(declination_sine, degrees(ahead));
}

// Azimuth and elevation without air, so many degrees after the sun crossed the meridian.
vec2 sun_over(float latitude, float declination_sine, float hour_angle) {
    vec2 here = cos_sin_degrees(latitude);
    vec2 hour = cos_sin_degrees(hour_angle);
    float declination_cosine = sqrt(max(1.0 - declination_sine * declination_sine, 0.0));
    float east = -declination_cosine * hour.y;
    float north = declination_sine * here.x - declination_cosine * hour.x * here.y;
    float up = declination_sine * here.y + declination_cosine * hour.x * here.x;
    float level = length(vec2(east, north));
    // An arc tangent tells angles near the zenith apart, which an arc sine does not. Of two zeros
    // it is undefined, and one compiler makes no number of it as soon as the first is known to be
    // 0.
    float azimuth = east == 0.0 ? (north < 0.0 ? 180.0 : 0.0) : degrees(atan(east, north));
    return vec2(azimuth < 0.0 ? azimuth + 360.0 : azimuth, degrees(atan(up, max(level, 1e-7))));
}

// How much higher than it is the air shows what has this elevation.
float refraction(float elevation) {
    float tangent = tan(radians(clamp(elevation, -89.0, 85.0)));
    float seconds = 0.0;
    if (elevation < -0.575) seconds = -20.774 / tangent;
    else if (elevation < 5.0) {
        float high = 103.4 + elevation * (-12.79 + elevation * 0.711);
        seconds = 1735.0 + elevation * (-518.2 + elevation * high);
    } else if (elevation < 85.0) {
        float cotangent = 1.0 / tangent;
        float square = cotangent * cotangent;
        seconds = cotangent * (58.1 + square * (-0.07 + square * 0.000086));
    }
    return seconds / 3600.0;
}

// How far the sky of stars has turned over a longitude, at so many hours of universal time: the
// right ascension that is on the meridian.
float sidereal_angle(float longitude, int year, int day, float hours) {
    float part = hours / 24.0 - 0.5;
    return turned_since_2000(280.46062, 0.01435263, days_from_2000(year, day), part)
            + 15.0 * (hours - 12.0) + longitude;
}

// The same by the sun's own time.
float sidereal_angle_solar(float longitude, int year, int day, float hours) {
    float universal = hours - longitude / 15.0;
    return sidereal_angle(longitude, year, day, universal)
            - sun_course(days_from_2000(year, day), universal).y;
}

// Azimuth and elevation as seen through the air, by universal time; `place` is latitude and
// longitude.
vec2 sun_position(vec2 place, int year, int day, float hours) {
    vec2 course = sun_course(days_from_2000(year, day), hours);
    vec2 sun = sun_over(place.x, course.x, 15.0 * (hours - 12.0) + place.y + course.y);
    return sun + vec2(0.0, refraction(sun.y));
}

// The same by the sun's own time, in which it crosses the meridian at 12.
vec2 sun_position_solar(vec2 place, int year, int day, float hours) {
    vec2 course = sun_course(days_from_2000(year, day), hours - place.y / 15.0);
    vec2 sun = sun_over(place.x, course.x, 15.0 * (hours - 12.0));
    return sun + vec2(0.0, refraction(sun.y));
}
#endif
