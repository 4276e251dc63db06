// objects/parameters/rocks.glsl -- how many models are drawn, and how deep they stand.
//
//   gives    objects, sunk
//   needs    nothing
//   units    shares of a model's height
//   source   none
//   tested   tests/glsl/test_objects.py
#ifndef OBJECTS_PARAMETERS_ROCKS
#define OBJECTS_PARAMETERS_ROCKS
uniform int objects = 4096;  //! slider(1, 65536) How many are drawn at most
uniform float sunk = 0.0;    //! slider(0, 1) step(0.01) How deep it stands in the ground
#endif
