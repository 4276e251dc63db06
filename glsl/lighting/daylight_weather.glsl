// lighting/daylight_weather.glsl -- what air and clouds are, from lighting/daylight.
//
//   gives    Weather, weather
//   needs    the output of lighting/daylight
//   units    light without unit, 1 that of the sun outside the air; turbidity and cover as
//            lighting/daylight has them
//   source   none: the order of texels in lighting/daylight/light
//   tested   tests/glsl/test_daylight.py: it says what is set
//
// For what draws either of them.
#ifndef LIGHTING_DAYLIGHT_WEATHER
#define LIGHTING_DAYLIGHT_WEATHER
struct Weather {
    float turbidity;  // 2 very clear, 3 clear, 6 hazy
    float open;       // share of the sky that clouds leave open
    float adapted;    // what all light is multiplied by for the eye
    vec3 overcast;    // light that clouds send down on level ground
    vec3 level;       // light of sun and sky on level ground
    float latitude;   // of the place [degrees]
    float sidereal;   // how far the sky of stars has turned [degrees]
};

Weather weather(sampler2D daylight) {
    vec4 cloud = texelFetch(daylight, ivec2(6, 0), 0);
    return Weather(texelFetch(daylight, ivec2(2, 0), 0).a, cloud.a,
                   texelFetch(daylight, ivec2(3, 0), 0).a, cloud.rgb,
                   texelFetch(daylight, ivec2(5, 0), 0).rgb,
                   texelFetch(daylight, ivec2(4, 0), 0).a,
                   texelFetch(daylight, ivec2(7, 0), 0).a);
}
#endif
