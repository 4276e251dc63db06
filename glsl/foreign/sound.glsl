// foreign/sound.glsl -- the spectrum and the wave of a sound file, for a channel of another tool.
//
//   gives    channel_texels: red, 0..1
//   needs    nothing; the processor reads the file (playground/data/media.py), with PyAV
//   units    seconds
//   source   W3C, Web Audio API (2021), section 1.8, AnalyserNode, as Shadertoy has it
//   tested   tests/glsl/test_foreign_over_time.py, against tones of known frequencies
//
// `channel` is Shadertoy's: 512 x 2 texels, the spectrum in row 0, texel k at k * 44100 / 2048
// Hz, -100 to -30 decibels; the wave in row 1, around 0.5. `waves` are the last samples, as many
// as the pass is wide, and `spectrum` all frequencies up to 22050 Hz: a row for each channel, the
// first in row 0, and of one row all of them mixed. Nothing is heard: a picture has no sound.
#pragma source("sound_file", output = "channel_texels:r8", reads = "time")

uniform sampler2D sound;      //! file("sketches/data/tones.flac") WAV, MP3, Ogg, FLAC or M4A
uniform float start = 0.0;    //! unit("s") What is heard at time 0, from the sound's beginning
uniform bool loop = true;     //! It begins again at its end; or silence follows
uniform int content = 0;      //! menu("channel", "waves", "spectrum") What the texels are
