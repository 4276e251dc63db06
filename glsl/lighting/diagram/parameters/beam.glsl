// lighting/diagram/parameters/beam.glsl -- what goes from a point to the sun.
//
//   gives    beam, elevation, radius, delta_r
//   needs    nothing
//   units    degrees; see each
//   source   Belaiche 2010, sections 3.5.4 and 4.4
//   tested   tests/glsl/test_diagrams.py
#ifndef LIGHTING_DIAGRAM_PARAMETERS_BEAM
#define LIGHTING_DIAGRAM_PARAMETERS_BEAM
uniform int beam = 0;            //! menu("ray", "cylinder", "cone")
                                 //! What goes from the point to the sun
uniform float elevation = 25.0;  //! angle(0, 89) group("Sun")
                                 //! Of the sun above the horizon; it is in the east
uniform float radius = 0.5;      //! slider(0, 64) step(0.1) group("Beam") unit("grey levels")
                                 //! The cylinder's; 255 grey levels are the height from 0 to 1
uniform float delta_r = 0.01;    //! slider(0, 2) step(0.001) group("Beam") label("Δr")
                                 //! What the cone's radius grows over one unit of path
#endif
