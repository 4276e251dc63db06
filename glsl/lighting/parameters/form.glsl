// lighting/parameters/form.glsl -- a march or a sweep for the shadows, and its horizon.
//
//   gives    horizon, form
//   needs    nothing
//   units    tangents, as lighting/sun_sweep gives them
//   source   none: a choice
//   tested   tests/glsl/test_shadows.py
#ifndef LIGHTING_PARAMETERS_FORM
#define LIGHTING_PARAMETERS_FORM
uniform sampler2D horizon;  //! input("black")
uniform int form = 0;       //! menu("march", "sweep") preview("sweep") group("March")
                            //! March from every texel, or sweep the terrain once along lines,
                            //! which is faster and nearly the same; without compute shaders the
                            //! sweep is slow, and a march is made instead
#endif
