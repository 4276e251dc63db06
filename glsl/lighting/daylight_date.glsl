// lighting/daylight_date.glsl -- the day of the year, from lighting/daylight or a parameter.
//
//   gives    day_of_year
//   needs    the output of lighting/daylight, or one black texel, and whether it is wired
//   units    days from the first of January
//   source   none: the order of texels in lighting/daylight/light
//   tested   tests/glsl/test_trees_light.py, wired and not
#ifndef LIGHTING_DAYLIGHT_DATE
#define LIGHTING_DAYLIGHT_DATE

// `day` is what is given for the parameter.
float day_of_year(bool wired, sampler2D daylight, float day) {
    return wired ? texelFetch(daylight, ivec2(5, 0), 0).a : day;
}
#endif
