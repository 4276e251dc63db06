// texturing/alpha_map/mask.glsl -- four weights a texel from an image's channels, drawn elsewhere.
//
//   gives    mask, four numbers 0..1, of any sum
//   needs    nothing; the processor reads the file (playground/engine/file_sources.py)
//   units    the image's numbers as they are, not decoded to linear light; texels
//   source   Belaiche 2010, section 2.6: alpha maps loaded from disk, four in one image
//   tested   tests/glsl/test_splat_mask.py, against the file's own numbers
//
// The image's first row is north. It may have any size with the proportions of this pass and
// is resampled, corners on corners; where `texels` states a size, another is refused.
#pragma source("mask_file", output = "mask:rgba8")

uniform sampler2D image;            //! file("sketches/data/splat_mask.png", "paint")
                                    //! PNG, JPEG or WebP: red, green, blue and alpha are the
                                    //! weights of the first to the fourth layer; without an alpha
                                    //! channel there is no fourth
uniform ivec2 texels = ivec2(0);    //! label("Size of the image") parts("width", "height")
                                    //! Width and height that the image must have; 0: any
