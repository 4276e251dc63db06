// foreign/keys.glsl -- the keyboard, for a channel of another tool.
//
//   gives    channel_texels: red, 1 or 0
//   needs    nothing; the window has a keyboard (playground/data/live_inputs.py)
//   units    none
//   source   Shadertoy's layout: 256 x 3 texels, the column is the key's code in JavaScript
//   tested   tests/glsl/test_foreign_live.py, by keys that go down and up
//
// Row 0 says whether a key is down, row 1 whether it went down in this very frame, row 2 changes
// each time that it goes down. Without a window, as in a shot, all is 0.
#pragma source("keyboard", output = "channel_texels:r8", reads = "keys")
