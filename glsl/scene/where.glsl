// scene/where.glsl -- which point of the terrain each pixel sees: drawn once, lit later.
//
//   gives    seen: the point east, north and up, and what it is as scene/surfaces.glsl has it
//   needs    scene/surfaces.glsl, view/vertices.glsl, view/surface.glsl; a height 0..1, and for
//            tiles what view/geomipmap/errors gives
//   units    metres
//   source   Saito and Takahashi 1990, "Comprehensible Rendering of 3-D Shapes" (SIGGRAPH):
//            geometry in buffers, shading afterwards
//   tested   tests/glsl/test_scene.py, against the camera's rays on a plane in float64
//
// It has one sample: a mean of two points would be neither. Draws that add something begin with
// it and its depth (`initial`), as trees do.
#include "scene/surfaces.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "seen:rgba32f", samples = 1)

#include "view/parameters/shape.glsl"

vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark) {
    return vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
}

vec4 fragment(vec3 position, float mark) {
    return vec4(position, mark < BROKEN ? BROKEN_GROUND : mark > 0.0 ? packed_cut(mark) : TOP);
}
