// lighting/parameters/directions.glsl -- the directions in which horizons are measured.
//
//   gives    directions, first, keep
//   needs    nothing
//   units    degrees
//   source   Belaiche 2010, section 3.4
//   tested   tests/glsl/test_horizons.py
#ifndef LIGHTING_PARAMETERS_DIRECTIONS
#define LIGHTING_PARAMETERS_DIRECTIONS
uniform int directions = 8;  //! slider(2, 64) step(2)
                             //! Directions around that K is of, a multiple of eight; below eight,
                             //! two opposite ones, each for half of the sky
uniform float first = 0.0;   //! angle(-360, 360) unit("°")
                             //! Azimuth of the first direction; the others follow counterclockwise
uniform bool keep = true;    //! Keep the horizons of eight directions; without, only K is found
#endif
