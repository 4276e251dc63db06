// generation/heightmap.glsl -- terrain from an elevation file: real, or painted.
//
//   gives    height: 0 at the file's lowest, 1 at its highest
//   needs    nothing; the processor reads the file (playground/data/elevation.py)
//   units    heights without unit; the sketch's relief, base elevation and extent take the metres
//            of the file or of `metres` unless it sets its own. Only pictures have no heights
//   source   Belaiche 2010, section 2.3.1, for heights as greys in [a, b]
//   tested   tests/glsl/test_heightmap.py, against the file's own numbers
//
// The file's first row is north, as in every image, unless `first_row` says south. At
// another size than the file's it is resampled, corners on corners.
#pragma source("elevation_file", output = "height:r32f")

uniform sampler2D elevation;         //! file("sketches/data/jacksboro_fault_dem.npz") PNG, NPY,
                                     //! NPZ, R16, RAW; by GDAL TIFF, VRT, IMG, JP2, GPKG, NC,
                                     //! HGT, ASC, BIL, FLT
uniform int longest = 0;             //! slider(0, 16384) label("Texels at most") Texels of the
                                     //! terrain's longer side, where the sketch has no size; 0:
                                     //! as many as the file has, and 4097 of a very large one
uniform ivec2 raw_size = ivec2(0);   //! label("Size of raw files") parts("width", "height") Width
                                     //! and height of an R16 or RAW file; 0: it is square
uniform int packing = 0;             //! menu("grey", "rgb") Greys, or heights packed in three
                                     //! channels as R·65536 + G·256 + B
uniform int no_data = 0;             //! menu("refuse", "fill") label("Gaps") A file with gaps is
                                     //! refused, or they are filled smoothly from their rims
uniform int first_row = 0;           //! menu("north", "south") Which edge the file begins with:
                                     //! north as in images, south in arrays that `render
                                     //! --texture` wrote
uniform vec2 metres = vec2(0.0);     //! unit("m") parts("black", "white") Elevations of the file's
                                     //! black and white; equal: as the file says
