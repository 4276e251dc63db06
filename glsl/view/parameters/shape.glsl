// view/parameters/shape.glsl -- the mesh of the terrain.
//
//   gives    height, spans, errors, detail, grid, tolerance, skirt
//   needs    nothing
//   units    see each
//   source   Belaiche 2010, section 2.5
//   tested   tests/glsl/test_view.py
#ifndef VIEW_PARAMETERS_SHAPE
#define VIEW_PARAMETERS_SHAPE
uniform sampler2D height;                       //! input("linear")
uniform sampler2D spans;                        //! input("black")
uniform sampler2D errors;                       //! input("black")
uniform int detail = 0;                         //! menu("full grid", "geomipmap", "morph")
                                                //! group("Mesh")
                                                //! How fine the mesh is where: alike everywhere,
                                                //! by tiles, or by tiles that morph into each
                                                //! other
uniform int grid = 257;                         //! slider(2, 1025) group("Mesh")
                                                //! Vertices a side of the full grid
uniform float tolerance = 1.0;                  //! slider(0, 16) step(0.1) unit("pixels")
                                                //! group("Mesh")
                                                //! How far a coarser level may lie from the
                                                //! terrain
uniform float skirt = 0.03;                     //! slider(0, 0.5) step(0.005) group("Mesh")
                                                //! How far the cut earth reaches below height 0,
                                                //! over the terrain's width
#endif
