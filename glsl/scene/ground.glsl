// scene/ground.glsl -- what every pixel reads of the ground that it shows, in one texture.
//
//   gives    ground: slopes east and north, the share of the sky above, the sun's visible part
//   needs    terrain/heightfield.glsl, terrain/maps.glsl; a height 0..1; a visibility and a sky
//            factor of a light technique, if there are
//   units    slopes in metres over metres; shares 0..1
//   source   none for the packing; that slopes are averaged, and normals are not: Olano and Baker
//            2010, "LEAN Mapping" (I3D), section 3
//   tested   tests/glsl/test_scene.py, against planes and NumPy
//
// Its levels of detail are right means: slopes are, where those of normals would be too short.
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#pragma kernel(output = "ground:rgba16f", relief = "shown")

uniform sampler2D height;      //! input
uniform sampler2D visibility;  //! input("white")
uniform sampler2D sky_factor;  //! input("white")

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 slope = relief * slope_at(height, place_on(grid, texel, size), spacing_of(grid, extent),
                                   CENTRAL_DIFFERENCES);
    float sun = wired_visibility ? map_at(visibility, texel, size).r : 1.0;
    // A sky factor has three channels where ground throws coloured light back.
    vec3 sky = wired_sky_factor ? map_at(sky_factor, texel, size).rgb : vec3(1.0);
    return vec4(slope, (sky.r + sky.g + sky.b) / 3.0, sun);
}
