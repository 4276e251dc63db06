// lighting/parameters/sunlight.glsl -- how bright the sun is, and its colour.
//
//   gives    sun_colour, gain
//   needs    nothing
//   units    light without unit, 1 for white
//   source   Belaiche 2010, section 5.4: a gain of 2
//   tested   tests/glsl/test_lighting.py
#ifndef LIGHTING_PARAMETERS_SUNLIGHT
#define LIGHTING_PARAMETERS_SUNLIGHT
uniform vec3 sun_colour = vec3(1.0);  //! colour group("Sun") Colour of the sun's light
uniform float gain = 2.0;             //! slider(0, 4) step(0.05) group("Sun")
                                      //! The sun's light is multiplied by it
#endif
