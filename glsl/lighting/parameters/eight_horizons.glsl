// lighting/parameters/eight_horizons.glsl -- eight horizons of each texel, and where they begin.
//
//   gives    ahead, behind, first
//   needs    nothing
//   units    tangents; degrees
//   source   Belaiche 2010, section 3.4
//   tested   tests/glsl/test_sky.py
#ifndef LIGHTING_PARAMETERS_EIGHT_HORIZONS
#define LIGHTING_PARAMETERS_EIGHT_HORIZONS
uniform sampler2D ahead;    //! input
uniform sampler2D behind;   //! input
uniform float first = 0.0;  //! angle(-360, 360) unit("°")
                            //! Azimuth of the first horizon; the others follow counterclockwise by
                            //! 45 degrees
#endif
