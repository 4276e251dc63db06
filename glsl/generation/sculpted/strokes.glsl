// generation/sculpted/strokes.glsl -- what the brush has painted: a number a texel.
//
//   gives    painted; of a sculpture in metres
//   needs    nothing; the processor reads the file (playground/engine/file_sources.py)
//   units    the file's numbers as they are, of either sign
//   source   derived here
//   tested   tests/studio/test_sculpting.py, against the file's own numbers
//
// The file's first row is north. It may have any size and is resampled, corners on corners. In
// the window B takes the brush; the sketch's own file is never written to.
#pragma source("numbers_file", output = "painted:r32f")

uniform sampler2D image;    //! file("sketches/data/not_sculpted.tif", "paint")
                            //! erode("erosion/brush") TIFF of 32-bit floats, or any elevation file
