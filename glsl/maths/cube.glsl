// maths/cube.glsl -- the directions of a cube map's texels, as OpenGL numbers its faces.
//
//   gives    cube_direction
//   needs    nothing
//   units    none; +Y up, as cube maps have it
//   source   OpenGL 4.6 core, table 8.19, solved for the direction
//   tested   tests/glsl/test_foreign.py, against the table in NumPy
#ifndef MATHS_CUBE
#define MATHS_CUBE

// From the cube's middle to a place, each coordinate -1..1, on a face: +X -X +Y -Y +Z -Z from 0.
vec3 cube_direction(int face, vec2 place) {
    float facing = (face & 1) == 0 ? 1.0 : -1.0;
    if (face < 2) return vec3(facing, -place.y, -facing * place.x);
    if (face < 4) return vec3(place.x, facing, facing * place.y);
    return vec3(facing * place.x, -place.y, facing);
}
#endif
