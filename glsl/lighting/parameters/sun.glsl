// lighting/parameters/sun.glsl -- where the sun is: a parameter, or a wired daylight.
//
//   gives    daylight, sun
//   needs    nothing
//   units    degrees; the texels of daylight as in lighting/daylight_reading.glsl
//   source   none: parameters
//   tested   tests/glsl/test_daylight.py
#ifndef LIGHTING_PARAMETERS_SUN
#define LIGHTING_PARAMETERS_SUN
uniform sampler2D daylight;            //! input("black")
uniform vec2 sun = vec2(135.0, 25.0);  //! direction group("Sun")
                                       //! Azimuth clockwise from north, elevation above the
                                       //! horizon
#endif
