// generation/from_example.glsl -- terrain like an example, along the ridges of a sketch.
//
//   gives    height, 0 at the lowest
//   needs    nothing; the processor makes it (playground/data/by_example.py)
//   units    heights without unit; where the file tells its metres, the sketch's relief and base
//            elevation take them unless it sets its own. Metres are the file's: terrain of finer
//            texels is as smooth as the example between its own
//   source   Zhou, Sun, Turk and Rehg 2007, "Terrain Synthesis from Digital Elevation Models"
//            (IEEE TVCG 13(4)); Efros and Freeman 2001, "Image Quilting" (SIGGRAPH)
//   tested   tests/engine/test_example.py, by the example's slopes, spectrum and drainage, and by
//            each part against brute force
//
// Square pieces of the example, turned and mirrored, are laid along the guide's ridges and valleys
// first, and then between them; each is the one that fits best what is there and what is wanted.
// They are cut where they differ least, and joined by their slopes.
//
// The guide is any height, or a picture: what is lighter than around it is a ridge, what is darker
// a valley. Where it is even, or nothing is wired, any piece will do that fits its neighbours.
#pragma source("example_file", output = "height:r32f", reads = "spacing, relief")

uniform sampler2D guide;             //! input("black")
uniform sampler2D elevation;         //! file("sketches/data/jacksboro_fault_dem.npz")
                                     //! label("Example") Real terrain, in any format that
                                     //! generation/heightmap reads
uniform float texel = 0.0;           //! unit("m") label("Example's texel") Of a file that does not
                                     //! say it; 0: as the file says, or as large as the terrain's
uniform float rise = 0.0;            //! unit("m") label("Example's rise") From its lowest height
                                     //! to its highest; 0: as the file says, or the relief
uniform float piece = 3840.0;        //! log_slider(100, 100000) unit("m") Side of the pieces, 12
                                     //! to 192 texels: the smaller, the closer they follow the
                                     //! guide and the less they look like the example
uniform int candidates = 2000;       //! log_slider(50, 10000) Pieces to choose from
uniform float follow = 0.5;          //! slider(0, 1) step(0.01) How closely the guide is followed
uniform uint seed = 1u;              //! slider(0, 9999) Which terrain
