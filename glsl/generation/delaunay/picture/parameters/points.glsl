// generation/delaunay/picture/parameters/points.glsl -- points, and their picture.
//
//   gives    places, last, points, marked, window, margin
//   needs    nothing
//   units    as each says
//   source   none
//   tested   tests/glsl/test_delaunay.py, with what reads them
#ifndef GENERATION_DELAUNAY_PICTURE_PARAMETERS_POINTS
#define GENERATION_DELAUNAY_PICTURE_PARAMETERS_POINTS
uniform sampler2D places;      //! input
uniform sampler2D last;        //! input
uniform int points = 1000;     //! slider(0, 10000) No more points than this are drawn
uniform int marked = 0;        //! menu("nothing", "an edge", "a flip", "the last insertion")
                               //! What is marked
uniform vec4 window = vec4(0.0, 0.0, 1.0, 1.0);  //! slider(0, 1) step(0.01) group("Picture")
    //! parts("left", "lower", "right", "upper") The part of the picture that it takes: its lower
    //! left, its upper right
uniform float margin = 0.1;    //! slider(0, 0.45) step(0.01) group("Picture") Room around the
                               //! terrain, over the window
#endif
