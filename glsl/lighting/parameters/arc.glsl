// lighting/parameters/arc.glsl -- the horizons that count for the sun, and its arc.
//
//   gives    measured, arc
//   needs    nothing
//   units    degrees, clockwise from north
//   source   Belaiche 2010, section 3.4
//   tested   tests/glsl/test_analytic.py
#ifndef LIGHTING_PARAMETERS_ARC
#define LIGHTING_PARAMETERS_ARC
uniform int measured = 0;     //! menu("on its arc", "eight directions") group("Sun")
                              //! A sun that keeps to its arc needs two horizons; with eight it may
                              //! be anywhere, as that of a daylight always does
uniform float arc = -360.0;   //! angle follows("sun", "measured", "on its arc") group("Sun")
                              //! Azimuth of the first horizon, and of the sun's arc, which goes on
                              //! through the zenith. Unless set, the arc is under the sun, and its
                              //! horizons are computed again when the sun's azimuth changes. Off
                              //! an arc that is set, its horizon is interpolated from eight
#endif
