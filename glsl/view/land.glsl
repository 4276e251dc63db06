// view/land.glsl -- the terrain as a mesh, with colour and light at every pixel.
//
//   gives    frame, linear light, over an earlier frame
//   needs    view/vertices.glsl, view/surface.glsl, view/facets.glsl, view/wires.glsl,
//            texturing/detail_near.glsl, lighting/daylight_sky.glsl, view/parameters/; a height
//            0..1, a colour, a light and a detail image if there are, and for tiles what
//            view/geomipmap/errors gives
//   units    metres; colours linear
//   source   Belaiche 2010, section 2.3, figures 2.2 (wires) and 2.5 (texture), figure 1.3
//            (facets), and section 2.7 (the detail image); the rest made here
//   tested   tests/glsl/test_view.py, by where marked terrain is in the picture; facets in
//            tests/glsl/test_facets.py, against the normals of the faces in float64; tiles in
//            tests/glsl/test_view_geomipmap.py and tests/glsl/test_view_morph.py; the detail image
//            in tests/glsl/test_texturing_detail.py, against rays in float64
//
// The mesh has `grid` vertices a side, far fewer than the heightmap has texels: a 1025 x 1025 mesh
// costs six times the frame, and light carries the detail that its facets lack. By tiles
// (section 2.5, geomipmap) it has one for each texel and draws fewer triangles. Asked to, each
// facet is lit by its own normal instead, so that the mesh itself is what one sees.
//
// A detail image lies over the cover, seen the more the nearer the eye: the cover's colour is the
// mean of what one sees, the detail only moves it up and down.
#include "lighting/daylight_sky.glsl"
#include "maths/drape.glsl"
#include "texturing/detail_near.glsl"
#include "view/facets.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#include "view/wires.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f")

uniform sampler2D colour;  //! input("linear", "mipmap", "white")
uniform sampler2D light;   //! input("linear", "mipmap", "white")
uniform sampler2D daylight;  //! input("black")
#include "view/parameters/mesh.glsl"
#include "view/parameters/wires.glsl"
#include "view/parameters/facets.glsl"
#include "view/parameters/detail_image.glsl"
#include "view/parameters/haze.glsl"
uniform int sky = 0;  //! menu("colours", "daylight") group("Sky")
                      //! Whether the haze has that colour, or that of the sky of lighting/daylight

// net: the place in the tile, its level, and how it is joined or how far it reaches.
vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark, out vec4 net) {
    net = vec4(corner.xy, tile.zw);
    return vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
}

vec4 fragment(vec3 position, float mark, vec4 net) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, drape_uv(share, textureSize(colour, 0)), SHARPER).rgb;
    if (wired_detail_image) {
        // Tiles are square on the ground. The level after the last is the last: the image's mean.
        vec2 tile = share * detail_repeats * vec2(1.0, extent.y / extent.x);
        vec3 fine = texture(detail_image, tile, SHARPER).rgb;
        vec3 mean = textureLod(detail_image, vec2(0.5), 99.0).rgb;
        float nearness = detail_nearness(distance(eye, position), detail_max_distance);
        shown = with_detail(shown, fine, mean, detail_strength * nearness);
    }
    shown *= facets ? vec3(light_of_face(position, facet_sun, facet_ambient))
                    : texture(light, drape_uv(share, textureSize(light, 0)), SHARPER).rgb;
    if (wireframe && detail == 0) {
        shown = mix(shown * faces, wire, wires(share * float(grid - 1), 1.0));
    }
    if (wireframe && detail != 0) {
        float lines = wires_of_tiles(net, detail == 2);
        shown = mix(shown * faces, levels ? colour_of_level(int(net.z + 0.5)) : wire, lines);
    }
    shown = cut_or(shown, earth, share, mark);
    vec3 air = horizon;
    if (sky == 1 && wired_daylight) air = horizon_of(daylight, 0.001 * (base_elevation + eye.z));
    if (haze > 0.0) shown = through_air(shown, air, haze, distance(eye, position), extent);
    return vec4(shown, 1.0);
}
