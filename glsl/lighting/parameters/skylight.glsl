// lighting/parameters/skylight.glsl -- light from everywhere.
//
//   gives    sky_colour, ambient
//   needs    nothing
//   units    light without unit, 1 for white
//   source   Belaiche 2010, section 3.5.3
//   tested   tests/glsl/test_lighting.py
#ifndef LIGHTING_PARAMETERS_SKYLIGHT
#define LIGHTING_PARAMETERS_SKYLIGHT
uniform vec3 sky_colour = vec3(1.0);  //! colour group("Sky") Colour of the light from everywhere
uniform float ambient = 0.0;          //! slider(0, 1) step(0.01) group("Sky")
                                      //! Light from everywhere, in shadow too
#endif
