// view/parameters/wires.glsl -- the edges of the mesh, drawn over it.
//
//   gives    wireframe, levels, wire, faces
//   needs    nothing
//   units    colours linear
//   source   Belaiche 2010, section 2.3, figure 2.2
//   tested   tests/glsl/test_view.py
#ifndef VIEW_PARAMETERS_WIRES
#define VIEW_PARAMETERS_WIRES
uniform bool wireframe = false;              //! group("Mesh")
                                             //! Draw the mesh's edges; hidden ones stay hidden
uniform bool levels = false;                 //! group("Mesh") label("Colour by level")
                                             //! Draw those edges in a colour for each level of
                                             //! detail
uniform vec3 wire = vec3(0.75, 0.82, 0.88);  //! colour group("Mesh") The edges' colour
uniform float faces = 1.0;                   //! slider(0, 1) step(0.01) group("Mesh")
                                             //! How bright the faces between the edges are
#endif
