// view/ground.glsl -- which place of the terrain each pixel shows.
//
//   gives    ground: as view/ground_texel.glsl packs it, over nothing
//   needs    view/ground_texel.glsl, view/vertices.glsl; a height 0..1, and for tiles of the mesh
//            what view/geomipmap/errors gives
//   units    metres
//   source   Deering et al. 1988, "The triangle processor and normal vector shader", SIGGRAPH '88:
//            shading after visibility
//   tested   tests/glsl/test_view_ground.py, against the plane of level ground in float64
//
// The first of two draws. A software renderer shades whole blocks of pixels for each triangle that
// touches one, so that a mesh of small triangles costs several times its pixels: here a block
// costs little. The second draw (view/shaded, view/splat/shaded) works each pixel out once.
#include "view/ground_texel.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "ground:rg32f", samples = 1)

#include "view/parameters/shape.glsl"

// place: east and north in metres, and the mark of place_of_vertex.
vec4 vertex(vec3 corner, vec4 tile, out vec3 place) {
    vec3 position;
    float mark;
    vec4 clip = vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
    place = vec3(position.xy, mark);
    return clip;
}

vec4 fragment(vec3 place) {
    return ground_texel(place.xy, place.z);
}
