// lighting/parameters/march.glsl -- what a ray march towards the sun reads, and its steps.
//
//   gives    height, step_length, sampling
//   needs    nothing
//   units    texels; heights without unit
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_shadows.py
#ifndef LIGHTING_PARAMETERS_MARCH
#define LIGHTING_PARAMETERS_MARCH
uniform sampler2D height;        //! input
uniform float step_length = 1.0; //! slider(0.25, 4) step(0.25) group("March") unit("texels")
                                 //! Length of a step, along the axis that the ray follows more.
                                 //! Long steps jump over ridges
uniform int sampling = 0;        //! menu("interpolated", "cut down") group("March")
                                 //! Heights between texels, or of the texel that a place is cut
                                 //! down to, as in the thesis
#endif
