// clouds/parameters/drawn.glsl -- what clouds are drawn, and throw shadows.
//
//   gives    clouds
//   needs    nothing
//   units    see there
//   source   none: a parameter
//   tested   tests/glsl/test_cloud_pictures.py, tests/glsl/test_scene_sky.py
//
// Where none are, daylight's own cover is over all of the sky evenly.
#ifndef CLOUDS_PARAMETERS_DRAWN
#define CLOUDS_PARAMETERS_DRAWN
uniform int clouds = 2;  //! menu("none", "flat", "heaped")
                         //! What clouds are drawn: none, flatter ones for slow renderers, or
                         //! heaps
#endif
