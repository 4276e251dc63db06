// foreign/microphone.glsl -- the computer's microphone, for a channel of another tool.
//
//   gives    channel_texels: red, 0..1
//   needs    nothing; the window listens (playground/data/live_inputs.py), with sounddevice
//   units    none
//   source   W3C, Web Audio API (2021), section 1.8, AnalyserNode, as Shadertoy has it
//   tested   tests/glsl/test_foreign_live.py, by a device of the test's own
//
// What the texels are: see foreign/sound.glsl. Without a window or a microphone it is silent, and
// a warning says so. Nothing that is heard is kept.
#pragma source("microphone", output = "channel_texels:r8", reads = "microphone")

uniform int content = 0;  //! menu("channel", "waves", "spectrum") What the texels are
