// lighting/parameters/sun_shape.glsl -- what represents the sun in a sweep.
//
//   gives    shape, spread
//   needs    nothing
//   units    see each
//   source   none: parameters
//   tested   tests/glsl/test_shadows.py
#ifndef LIGHTING_PARAMETERS_SUN_SHAPE
#define LIGHTING_PARAMETERS_SUN_SHAPE
uniform int shape = 0;       //! menu("point", "cone", "disc") group("Sweep")
                             //! What represents the sun
uniform float spread = 0.0;  //! slider(0, 20) step(0.01) group("Sweep")
                             //! Of a cone, its radius over its length; of a disc, its diameter in
                             //! degrees
#endif
