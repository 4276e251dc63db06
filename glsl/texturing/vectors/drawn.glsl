// texturing/vectors/drawn.glsl -- points, lines and polygons of a file, as a mask on the terrain.
//
//   gives    mask: how much of each texel they cover
//   needs    nothing; the processor reads both files (playground/engine/file_sources.py)
//   units    width in metres; mask 0..1
//   source   made here; GeoJSON is RFC 7946
//   tested   tests/data/test_vectors.py, against masks drawn much finer
//
// GeoJSON counts degrees on WGS 84; shapes in another reference system than the terrain's are
// transformed into that by GDAL. The extra gis reads the other formats. A reference system that
// a file does not name is taken for the terrain's.
#pragma source("vector_file", output = "mask:r32f")

uniform sampler2D vectors;    //! file("sketches/data/jacksboro_grid.geojson") label("Vector data")
                              //! GeoJSON, or GPKG, SHP, FGB, KML or GPX: points, lines, polygons
uniform sampler2D elevation;  //! file("sketches/data/jacksboro_fault_dem.npz") label("Elevations")
                              //! The terrain's elevation file, which says where it lies
uniform float width = 60.0;   //! log_slider(0.1, 10000) unit("m") Of lines, and across points
uniform int polygons = 0;     //! menu("filled", "outlined") Whether polygons are areas or lines
