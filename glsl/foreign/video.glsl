// foreign/video.glsl -- a video file for a channel of another tool, encoded as in the file.
//
//   gives    channel_texels, colours encoded for the display
//   needs    nothing; the processor reads the file (playground/data/media.py), with PyAV
//   units    seconds
//   source   made here
//   tested   tests/glsl/test_foreign_over_time.py, against films of known colours
//
// The frame is the one that the file shows at a time: the picture is a function of the time. A
// pass of no size of its own has the film's; to another size frames are averaged over areas, or
// interpolated bilinearly. North is on top.
#pragma source("video_file", output = "channel_texels:rgba8", reads = "time")

uniform sampler2D video;      //! file("sketches/data/sun_flight.mp4") MP4, MOV, WebM, MKV, GIF or
                              //! AVI
uniform float start = 0.0;    //! unit("s") What is shown at time 0, from the film's beginning
uniform float speed = 1.0;    //! slider(-4, 4) step(0.05) Seconds of the film in a second
uniform bool loop = true;     //! It begins again at its end; or its last frame stays
