// erosion/painted_factor/factor.glsl -- 1 and what is painted, as a factor.
//
//   gives    factor, 0 to maximum; 1 where nothing is painted
//   needs    nothing
//   units    none
//   source   derived here
//   tested   tests/studio/test_sculpting.py, against NumPy
#pragma kernel(output = "factor:r32f")

uniform sampler2D painted;       //! input
uniform float maximum = 4.0;     //! slider(1, 16) step(0.5) Largest factor that can be painted

float kernel(ivec2 texel) {
    return clamp(1.0 + texelFetch(painted, texel, 0).r, 0.0, maximum);
}
