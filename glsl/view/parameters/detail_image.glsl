// view/parameters/detail_image.glsl -- an image over the cover, seen near the eye.
//
//   gives    detail_image, detail_repeats, detail_strength, detail_max_distance
//   needs    nothing
//   units    metres
//   source   Belaiche 2010, section 2.7
//   tested   tests/glsl/test_texturing_detail.py
#ifndef VIEW_PARAMETERS_DETAIL_IMAGE
#define VIEW_PARAMETERS_DETAIL_IMAGE
uniform sampler2D detail_image;        //! input("linear", "repeat", "mipmap", "white")
uniform float detail_repeats = 100.0;  //! slider(1, 2000) step(1) group("Detail image")
                                       //! label("Repeats")
                                       //! How often the detail image repeats from west to east
uniform float detail_strength = 1.0;   //! slider(0, 2) step(0.01) group("Detail image")
                                       //! label("Strength")
                                       //! How much of it is seen at the eye; 1: as its own greys
                                       //! have it
uniform float detail_max_distance = 2500.0;  //! log_slider(10, 50000) unit("m")
                                       //! group("Detail image") label("Max distance")
                                       //! Distance from the eye at which nothing of it is left
#endif
