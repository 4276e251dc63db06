// generation/sculpted/sum.glsl -- terrain, raised and lowered by metres.
//
//   gives    height, which may leave 0..1
//   needs    nothing; both inputs have the size of this pass
//   units    height in units of relief, the change in metres
//   source   derived here
//   tested   tests/studio/test_sculpting.py, against NumPy
#pragma kernel(output = "height:r32f")

uniform sampler2D height;        //! input
uniform sampler2D change;        //! input
uniform float amount = 1.0;      //! slider(0, 1) Share of the painted change that is added

float kernel(ivec2 texel) {
    float added = amount * texelFetch(change, texel, 0).r / max(relief, 1e-3);
    return texelFetch(height, texel, 0).r + added;
}
