// view/splat_multipass/first.glsl -- the land in its first texture, for others to be blended over it.
//
//   gives    frame, linear light, over an earlier frame
//   needs    view/splat/surface.glsl, view/surface.glsl, view/vertices.glsl; a height 0..1, a tile; a light if there is
//            one, and for tiles of the mesh what view/geomipmap/errors gives
//   units    metres; colours linear; the tile stands `repeats` times side by side from west to east
//   source   Belaiche 2010, section 2.6: the first of the draws
//   tested   tests/glsl/test_splat_view.py: with the layers over it, the picture of view/splat
//
// The first layer's alpha is 1 everywhere: what it leaves to the others they take from it.
#include "view/splat/surface.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f")

uniform sampler2D height;   //! input("linear")
uniform sampler2D colour;   //! input("linear", "repeat", "mipmap")
uniform sampler2D light;    //! input("linear", "mipmap", "white")
uniform sampler2D spans;    //! input("black")
uniform sampler2D errors;   //! input("black")

uniform int detail = 0;               //! menu("full grid", "geomipmap", "morph") group("Mesh") How fine the mesh is where: alike everywhere, by tiles, or by tiles that morph into each other
uniform int grid = 257;               //! slider(2, 1025) group("Mesh") Vertices a side of the full grid
uniform float tolerance = 1.0;        //! slider(0, 16) step(0.1) unit("pixels") group("Mesh") How far a coarser level may lie from the land
uniform float skirt = 0.03;           //! slider(0, 0.5) step(0.005) group("Mesh") How far the cut earth reaches below height 0, over the land's width
uniform vec3 earth = vec3(0.135, 0.10, 0.075);  //! colour group("Mesh") The cut earth's colour
uniform float repeats = 48.0;         //! slider(1, 512) step(1) group("Layers") How often the tile stands side by side from west to east
uniform float haze = 0.0;             //! slider(0, 2) step(0.01) group("Sky") Air between the eye and the land: how much a land's width of it takes away
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);  //! colour group("Sky") The haze's colour

vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark) {
    vec4 place = place_of_vertex(height, share_of_vertex(height, detail, corner, tile), corner.z, extent, relief, skirt);
    position = place.xyz;
    mark = place.w;
    return clip_from_world * vec4(position, 1.0);
}

vec4 fragment(vec3 position, float mark) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, share * vec2(1.0, extent.y / extent.x) * repeats).rgb;
    float clear = exp(-haze * distance(eye, position) / max(extent.x, extent.y));
    return vec4(surface_seen(shown, light, share, mark, earth, horizon, clear), 1.0);
}
