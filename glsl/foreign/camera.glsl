// foreign/camera.glsl -- a camera of the computer, for a channel of another tool.
//
//   gives    channel_texels, colours encoded for the display
//   needs    nothing; the window looks (playground/data/live_inputs.py), with PyAV
//   units    none
//   source   made here
//   tested   tests/glsl/test_foreign_live.py, by a camera of the test's own
//
// A pass of no size of its own has 640 x 480 texels, over which the picture is stretched. Without
// a window or a camera it is black, and a warning says so. Nothing that is seen is kept.
#pragma source("camera", output = "channel_texels:rgba8", reads = "camera")

uniform int device = 0;       //! slider(0, 9) label("Camera") Which camera: the first is 0
uniform bool mirror = false;  //! West and east are exchanged, as in a mirror
