// view/parameters/facets.glsl -- the faces of the mesh, each lit by its own normal.
//
//   gives    facets, facet_sun, facet_ambient
//   needs    nothing
//   units    degrees; light without unit
//   source   Belaiche 2010, figure 1.3
//   tested   tests/glsl/test_facets.py
#ifndef VIEW_PARAMETERS_FACETS
#define VIEW_PARAMETERS_FACETS
uniform bool facets = false;                 //! group("Mesh")
                                             //! Light each face by its own normal instead of by
                                             //! the light
uniform vec2 facet_sun = vec2(135.0, 30.0);  //! direction group("Mesh") label("Sun on facets")
                                             //! Where that light comes from
uniform float facet_ambient = 0.15;          //! slider(0, 1) step(0.01) group("Mesh")
                                             //! label("Sky on facets")
                                             //! Light on a level face that the sun does not reach
#endif
