// view/parameters/bloom.glsl -- how much of the light spreads.
//
//   gives    bloom
//   needs    nothing
//   units    share 0..1
//   source   none: a parameter
//   tested   tests/glsl/test_after.py
#ifndef VIEW_PARAMETERS_BLOOM
#define VIEW_PARAMETERS_BLOOM
uniform float bloom = 0.0;  //! slider(0, 0.3) step(0.005) group("Picture")
                            //! Share of all light that spreads around where it comes from, as in
                            //! a lens: what is very bright glows
#endif
