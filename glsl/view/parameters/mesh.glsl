// view/parameters/mesh.glsl -- the mesh of the terrain, and its cut.
//
//   gives    height, spans, errors, detail, grid, tolerance, skirt, earth
//   needs    view/parameters/shape.glsl, view/parameters/earth.glsl
//   units    see each; colours linear
//   source   Belaiche 2010, section 2.5
//   tested   tests/glsl/test_view.py
#ifndef VIEW_PARAMETERS_MESH
#define VIEW_PARAMETERS_MESH
#include "view/parameters/shape.glsl"
#include "view/parameters/earth.glsl"
#endif
