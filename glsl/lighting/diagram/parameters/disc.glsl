// lighting/diagram/parameters/disc.glsl -- the sun's disc over a section.
//
//   gives    elevation, diameter
//   needs    nothing
//   units    degrees
//   source   Belaiche 2010, section 3.4
//   tested   tests/glsl/test_diagrams.py
#ifndef LIGHTING_DIAGRAM_PARAMETERS_DISC
#define LIGHTING_DIAGRAM_PARAMETERS_DISC
uniform float elevation = 20.0;  //! angle(0, 90) group("Sun")
                                 //! Of the sun's middle above the horizon; it is in the east
uniform float diameter = 0.53;   //! slider(0, 30) step(0.01) unit("°") group("Sun")
                                 //! Angle that the sun's disc fills
#endif
