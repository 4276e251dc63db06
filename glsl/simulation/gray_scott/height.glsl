// simulation/gray_scott/height.glsl -- the substance V as a height.
//
//   gives    height, 0..1
//   needs    nothing
//   units    heights without unit
//   source   none: made here
//   tested   tests/glsl/test_gray_scott.py, against the amounts
#pragma kernel(output = "height:r32f")

uniform sampler2D amounts;   //! input
uniform float full = 0.4;    //! slider(0.05, 1) step(0.01) The amount of V that is height 1

float kernel(ivec2 texel) {
    return clamp(texelFetch(amounts, texel, 0).g / full, 0.0, 1.0);
}
