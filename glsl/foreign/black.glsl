// foreign/black.glsl -- black texels, where nothing feeds a channel of another tool's shader.
//
//   gives    channel_texels, 0 in every colour and 1 in alpha
//   needs    nothing
//   units    none
//   source   made here
//   tested   tests/glsl/test_foreign.py, by its value
#pragma kernel(output = "channel_texels:rgba8")

vec4 kernel(ivec2 texel) {
    return vec4(0.0, 0.0, 0.0, 1.0);
}
