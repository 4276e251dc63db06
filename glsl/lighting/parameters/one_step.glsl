// lighting/parameters/one_step.glsl -- the place that height difference looks at.
//
//   gives    sun, step_length
//   needs    nothing
//   units    degrees; texels
//   source   Belaiche 2010, section 3.5.1
//   tested   tests/glsl/test_height_difference.py
#ifndef LIGHTING_PARAMETERS_ONE_STEP
#define LIGHTING_PARAMETERS_ONE_STEP
uniform vec2 sun = vec2(135.0, 25.0);  //! direction group("Sun")
                                       //! Azimuth clockwise from north; this method knows no
                                       //! elevation
uniform float step_length = 1.0;       //! slider(0, 16) step(0.5) unit("texels")
                                       //! How far away that place is, along the axis that the sun
                                       //! is nearer to
#endif
