// view/land.glsl -- the land as a mesh: heights at its vertices, colour and light at every pixel.
//
//   gives    frame, linear light, over an earlier frame
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, lighting/sun.glsl,
//            maths/drape.glsl, maths/number.glsl, texturing/detail_near.glsl, view/surface.glsl, view/vertices.glsl, view/wires.glsl; a height 0..1, a colour, a
//            light and a detail image if there are, and for tiles what view/geomipmap/errors gives
//   units    metres; colours linear
//   source   Belaiche 2010, section 2.3, figures 2.2 (wires) and 2.5 (texture), figure 1.3
//            (facets), and section 2.7 (the detail image); the rest made here
//   tested   tests/glsl/test_view.py, by where marked land stands in the picture; facets in
//            tests/glsl/test_facets.py, against the normals of the faces in float64; tiles in
//            tests/glsl/test_view_geomipmap.py and tests/glsl/test_view_morph.py; the detail image
//            in tests/glsl/test_texturing_detail.py, against rays in float64
//
// The mesh has `grid` vertices a side, far fewer than the land has texels: a 1025 x 1025 mesh
// costs six times the frame, and light carries the detail that its facets lack. By tiles
// (section 2.5, geomipmap) it has one for each texel and draws fewer triangles. Asked to, each
// facet is lit by its own normal instead, so that the mesh itself is what one sees.
//
// A detail image lies over the cover, seen the more the nearer the eye: the cover's colour is the
// mean of what one sees, the detail only moves it up and down.
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "maths/drape.glsl"
#include "maths/number.glsl"
#include "texturing/detail_near.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#include "view/wires.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f")

uniform sampler2D height;  //! input("linear")
uniform sampler2D colour;  //! input("linear", "mipmap", "white")
uniform sampler2D light;   //! input("linear", "mipmap", "white")
uniform sampler2D daylight;  //! input("black")
uniform sampler2D detail_image;  //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D spans;   //! input("black")
uniform sampler2D errors;  //! input("black")

uniform int detail = 0;               //! menu("full grid", "geomipmap", "morph") group("Mesh") How fine the mesh is where: alike everywhere, by tiles, or by tiles that morph into each other
uniform int grid = 257;               //! slider(2, 1025) group("Mesh") Vertices a side of the full grid
uniform float tolerance = 1.0;        //! slider(0, 16) step(0.1) unit("pixels") group("Mesh") How far a coarser level may lie from the land
uniform bool wireframe = false;       //! group("Mesh") Draw the mesh's edges; hidden ones stay hidden
uniform bool levels = false;          //! group("Mesh") label("Colour by level") Draw those edges in a colour for each level of detail
uniform vec3 wire = vec3(0.75, 0.82, 0.88);  //! colour group("Mesh") The edges' colour
uniform float faces = 1.0;            //! slider(0, 1) step(0.01) group("Mesh") How bright the faces between the edges are
uniform bool facets = false;          //! group("Mesh") Light each face by its own normal instead of by the light
uniform vec2 facet_sun = vec2(135.0, 30.0);  //! direction group("Mesh") label("Sun on facets") Where that light comes from
uniform float facet_ambient = 0.15;   //! slider(0, 1) step(0.01) group("Mesh") label("Sky on facets") Light on a level face that the sun does not reach
uniform float skirt = 0.03;           //! slider(0, 0.5) step(0.005) group("Mesh") How far the cut earth reaches below height 0, over the land's width
uniform vec3 earth = vec3(0.135, 0.10, 0.075);  //! colour group("Mesh") The cut earth's colour
uniform float detail_repeats = 100.0; //! slider(1, 2000) step(1) group("Detail image") label("Repeats") How often the detail image stands side by side from west to east
uniform float detail_strength = 1.0;  //! slider(0, 2) step(0.01) group("Detail image") label("Strength") How much of it is seen at the eye; 1: as its own greys have it
uniform float detail_reach = 2500.0;  //! log_slider(10, 50000) unit("m") group("Detail image") label("Reach") Distance from the eye at which nothing of it is left
uniform float haze = 0.0;             //! slider(0, 2) step(0.01) group("Sky") Air between the eye and the land: how much a land's width of it takes away
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);  //! colour group("Sky") The haze's colour
uniform int sky = 0;  //! menu("colours", "daylight") group("Sky") Whether the haze has that colour, or that of the sky of lighting/daylight

// mark: as of place_of_vertex.
// net: the place in the tile, its level, and how it is joined or how far it reaches.
vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark, out vec4 net) {
    vec2 share = share_of_vertex(height, detail, corner, tile);
    vec4 place = place_of_vertex(height, share, corner.z, extent, relief, skirt);
    position = place.xyz;
    mark = place.w;
    net = vec4(corner.xy, tile.zw);
    return clip_from_world * vec4(position, 1.0);
}

#ifdef FRAGMENT_STAGE
// The light on the plane that a pixel's neighbours share with it: a face of the mesh.
float light_of_face(vec3 position) {
    vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
    // Which side is up depends on how the picture is turned, not on the land.
    normal *= normal.z < 0.0 ? -1.0 : 1.0;
    return sun_on(normal, to_sun(facet_sun)) + facet_ambient * (0.5 + 0.5 * normal.z);
}
#endif

vec4 fragment(vec3 position, float mark, vec4 net) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, drape_uv(share, textureSize(colour, 0)), SHARPER).rgb;
    if (wired_detail_image) {
        // Tiles are square on the ground. The level after the last is the last: the image's mean.
        vec3 fine = texture(detail_image, share * detail_repeats * vec2(1.0, extent.y / extent.x), SHARPER).rgb;
        vec3 mean = textureLod(detail_image, vec2(0.5), 99.0).rgb;
        shown = with_detail(shown, fine, mean, detail_strength * detail_nearness(distance(eye, position), detail_reach));
    }
    shown *= facets ? vec3(light_of_face(position))
                    : texture(light, drape_uv(share, textureSize(light, 0)), SHARPER).rgb;
    if (wireframe && detail == 0) shown = mix(shown * faces, wire, wires(share * float(grid - 1), 1.0));
    if (wireframe && detail != 0) {
        int level = int(net.z + 0.5);
        // A tile that morphs has all of its triangles at any level; those that vanish have no pixels.
        bool morphs = detail == 2;
        float lines = wires_of_tile(net.xy, morphs ? 0 : level, morphs ? 0 : int(net.w + 0.5), 1.0);
        shown = mix(shown * faces, levels ? colour_of_level(level) : wire, lines);
    }
    if (mark > 0.0) shown = cut_of_land(earth, share, mark);
    if (mark < BROKEN || !is_number(shown.r + shown.g + shown.b)) shown = NOT_A_NUMBER;
    vec3 air = sky == 1 && wired_daylight ? horizon_of(daylight, 0.001 * (base_elevation + eye.z)) : horizon;
    if (haze > 0.0) shown = mix(air, shown, exp(-haze * distance(eye, position) / max(extent.x, extent.y)));
    return vec4(shown, 1.0);
}
