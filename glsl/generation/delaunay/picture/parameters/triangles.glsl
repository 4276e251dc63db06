// generation/delaunay/picture/parameters/triangles.glsl -- triangles, and which is marked.
//
//   gives    triangles, neighbours, number
//   needs    nothing
//   units    as each says
//   source   none
//   tested   tests/glsl/test_delaunay.py, with what reads them
#ifndef GENERATION_DELAUNAY_PICTURE_PARAMETERS_TRIANGLES
#define GENERATION_DELAUNAY_PICTURE_PARAMETERS_TRIANGLES
uniform sampler2D triangles;   //! input
uniform sampler2D neighbours;  //! input
uniform int number = 0;        //! slider(0, 60000) Which edge, three to each triangle, or which
                               //! flip of the last insertion
#endif
