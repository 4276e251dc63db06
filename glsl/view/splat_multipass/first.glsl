// view/splat_multipass/first.glsl -- the terrain in its first texture.
//
//   gives    frame, linear light, over an earlier frame
//   needs    view/splat/surface.glsl, view/surface.glsl, view/vertices.glsl; a height 0..1, a
//            tile; a light if there is one, and for tiles of the mesh what view/geomipmap/errors
//            gives
//   units    metres; colours linear; the tile is `repeats` times side by side from west to
//            east
//   source   Belaiche 2010, section 2.6: the first of the draws
//   tested   tests/glsl/test_splat_view.py: with the layers over it, the picture of view/splat
//
// Others are blended over it.
//
// The first layer's alpha is 1 everywhere: what it leaves to the others they take from it.
#include "view/splat/surface.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f")

#include "view/parameters/mesh.glsl"
uniform sampler2D colour;   //! input("linear", "repeat", "mipmap")
uniform sampler2D light;    //! input("linear", "mipmap", "white")

uniform float repeats = 48.0;         //! slider(1, 512) step(1) group("Layers")
                                      //! How often the tile repeats from west to east
#include "view/parameters/haze.glsl"

vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark) {
    return vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
}

vec4 fragment(vec3 position, float mark) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, share * vec2(1.0, extent.y / extent.x) * repeats).rgb;
    return vec4(surface_seen(shown, light, position, mark, earth, horizon, haze), 1.0);
}
