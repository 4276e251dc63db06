// lighting/interreflection/add.glsl -- a method's light, with sky and interreflection.
//
//   gives    light: red, green, blue; alpha as in the light it was given
//   needs    lighting/daylight_reading.glsl, terrain/maps.glsl; a method's light; f and K
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, section 5.7, with the approximation of section 3.4, eq. 3.9
//   tested   tests/glsl/test_sky.py, against float64
//
// light = given + sky colour ambient f. Shadows of local methods are pitch black, since they
// leave out all light that comes by way of the sky and of other terrain. Asked to, the given light
// is thrown back as well: terrain that is seen is taken to be as bright as the place itself, so it
// grows by 1 / (1 - C (1 - K)) = f / K; that is for lit slopes, and adds nothing in a shadow.
#include "lighting/daylight_reading.glsl"
#include "terrain/maps.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D given;               //! input
uniform sampler2D factor;              //! input
uniform sampler2D k;                   //! input
uniform sampler2D daylight;            //! input("black")
uniform vec3 sky_colour = vec3(0.6, 0.78, 1.0);  //! colour group("Sky") Colour of the sky's light
uniform float ambient = 0.35;          //! slider(0, 2) step(0.01) group("Sky")
                                       //! Strength of the sky's light on open level ground
uniform bool both = false;             //! group("Sky") The given light is thrown back too

vec4 kernel(ivec2 texel) {
    vec4 light = map_at(given, texel, size);
    vec3 f = map_at(factor, texel, size).rgb;
    float open = map_at(k, texel, size).r;
    if (both && open > 1e-4) light.rgb *= f / open;
    vec3 sky = sunlight(wired_daylight, daylight, vec3(0.0), vec2(0.0), vec3(0.0), sky_colour).sky;
    return vec4(light.rgb + sky * (ambient * f), light.a);
}
