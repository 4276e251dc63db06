// lighting/diagram/parameters/section.glsl -- the part of the terrain that a section shows.
//
//   gives    row, first, last
//   needs    nothing
//   units    rows and columns of texels
//   source   none: parameters
//   tested   tests/glsl/test_diagrams.py
#ifndef LIGHTING_DIAGRAM_PARAMETERS_SECTION
#define LIGHTING_DIAGRAM_PARAMETERS_SECTION
uniform int row = 32;   //! slider(0, 4096) group("Section")
                        //! Row of the terrain that is drawn, from the south
uniform int first = 0;  //! slider(0, 4096) group("Section") First column shown
uniform int last = 0;   //! slider(0, 4096) group("Section") Last column shown; 0: the terrain's
#endif
