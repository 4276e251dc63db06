// objects/model.glsl -- the triangles of a modelled object, from a glTF file.
//
//   gives    place of each corner, metres east, north and up, and 1, or 0 after the last; facing,
//            its normal; tint, its colour
//   needs    nothing; trimesh reads the file, in the extra models (playground/data/models.py)
//   units    metres; colours linear
//   source   Khronos Group 2021, "glTF 2.0 Specification"
//   tested   tests/data/test_models.py
//
// Three corners a triangle, row by row from the south-west; y of the file is up.
#pragma source("model_file", output = "place:rgba32f, facing:rgba16f, tint:rgba8")

uniform sampler2D model;  //! file("sketches/data/rock.glb") GLB, or GLTF with its data inside
