// lighting/parameters/normal.glsl -- how the slope of the terrain is found.
//
//   gives    normal
//   needs    nothing
//   units    a choice: CENTRAL_DIFFERENCES or ONE_TRIANGLE of terrain/heightfield.glsl
//   source   Belaiche 2010, section 3.5.3: one triangle
//   tested   tests/glsl/test_lighting.py
#ifndef LIGHTING_PARAMETERS_NORMAL
#define LIGHTING_PARAMETERS_NORMAL
uniform int normal = 0;  //! menu("central differences", "one triangle")
                         //! How the slope is found; the thesis takes one triangle, to one side
#endif
