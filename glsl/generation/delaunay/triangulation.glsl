// generation/delaunay/triangulation.glsl -- points one by one, and the triangles between.
//
//   gives    places (x, y, height), triangles (three points, counter-clockwise), neighbours
//            (the triangle across from each point, -1 outside) and last (what the last
//            insertion did): entry k at texel (k % width, k / width)
//   needs    nothing; the processor triangulates (playground/data/delaunay.py)
//   units    places in lattice spacings, 2^24 along the terrain's longer side; heights without
//            unit; points and triangles by their numbers, the corners first
//   source   Belaiche 2010, section 1.3.8, its slip 5 fixed; Bowyer 1981 and Watson 1981
//            (The Computer Journal 24); Lawson 1977 (Software for C1 Surface Interpolation)
//   tested   tests/glsl/test_delaunay.py and tests/data/test_delaunay.py, against SciPy
//
// Four corners make two triangles; each further point goes to the barycentre of the triangle
// of greatest area. Entry 0 of `last` is (newest point or -1, entries that follow, edges
// replaced, triangles in all); entry 1 the triangle that the point fell into, the others the
// triangles destroyed beside it: the edge that led there, and the point across from it.
#pragma source("delaunay", \
               output = "places:rgba32f, triangles:rgba32f, neighbours:rgba32f, last:rgba32f")

uniform int points = 60;       //! slider(0, 10000) Points inserted after the four corners
uniform int weights = 0;       //! menu("equal", "random") A point is at its triangle's
                               //! barycentre, the corners weighted equally or at random
uniform int method = 0;        //! menu("destruction and construction", "flips") How triangles that
                               //! a new point makes illegal are repaired; the terrain is the same
uniform uint seed = 7u;        //! slider(0, 9999) Which terrain
uniform int heights = 0;       //! menu("random", "displaced") The thesis's random height, or that
                               //! of the triangle itself, displaced by a random amount
uniform float roughness = 1.0; //! slider(0, 3) step(0.01) Displaced heights only: the amount is
                               //! within k^roughness, k the square root of the triangle's share of
                               //! the terrain
uniform vec4 corners = vec4(0.5, 0.5, 0.5, 0.5);  //! slider(0, 1) step(0.01)
    //! parts("SW", "SE", "NW", "NE") Heights of the corners: south-west, south-east, north-west,
    //! north-east
uniform float proportion = 1.0; //! log_slider(0.125, 8) The terrain's length north over its length
                                //! east, so that circles are round on it
uniform int flips = -1;        //! slider(-1, 30) By flips only, to look at: the last insertion
                               //! stops after so many; -1: it makes all
