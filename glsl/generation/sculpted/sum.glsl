// generation/sculpted/sum.glsl -- terrain, raised and lowered by metres.
//
//   gives    height, which may leave 0..1
//   needs    nothing; both inputs have the size of this pass
//   units    height in units of relief, the change in metres
//   source   derived here
//   tested   tests/workbench/test_sculpted_sketch.py, against NumPy
#pragma kernel(output = "height:r32f")

uniform sampler2D height;        //! input
uniform sampler2D change;        //! input
uniform float amount = 1.0;      //! slider(0, 1) Share of the painted change that is added

float kernel(ivec2 texel) {
    return texelFetch(height, texel, 0).r + amount * texelFetch(change, texel, 0).r / relief;
}
