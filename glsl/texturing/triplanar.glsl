// texturing/triplanar.glsl -- an image projected onto the terrain from above and from the sides.
//
//   gives    colour, linear light
//   needs    lighting/sun.glsl, maths/land.glsl, terrain/heightfield.glsl,
//            texturing/kept_contrast.glsl, texturing/planes.glsl; an image that repeats,
//            and a height 0..1
//   units    the image is `repeats` times side by side from west to east, and is as large
//            upwards; slopes in degrees from the level
//   source   three planes weighted by the normal: Geiss 2007, "Generating Complex Procedural
//            Terrains Using the GPU" (GPU Gems 3, chapter 1); only on cliffs: made here
//   tested   tests/glsl/test_texturing_triplanar.py: how far it stretches on inclined planes
//
// So it does not stretch on cliffs.
//
// From above, an image on a slope of angle a is stretched down the slope by 1 / cos a: twice
// at 60 degrees, without limit on a wall. Where the terrain is steep the image is read in two
// upright planes as well, facing east and facing north. Level terrain is read once, as
// texturing/tiled reads it without variety.
//
// The texture is still one of the whole terrain: on a cliff its texels are far apart. What fits
// between them is read at the level of detail that does not flicker.
#include "lighting/sun.glsl"
#include "maths/land.glsl"
#include "terrain/heightfield.glsl"
#include "texturing/kept_contrast.glsl"
#include "texturing/planes.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;  //! input("linear", "repeat", "mipmap")
uniform sampler2D height;  //! input

uniform float repeats = 24.0;    //! slider(1, 256) step(1)
                                 //! How often the image repeats from west to east
uniform vec2 cliffs = vec2(30.0, 45.0);  //! slider(0, 90) step(1) unit("degrees")
                                         //! parts("seen from", "alone from")
                                         //! How steep terrain must be for its sides to be seen,
                                         //! and for them to be all that counts
uniform float sharpness = 4.0;   //! slider(1, 16) step(0.1)
                                 //! How narrow the borders are between the planes
uniform float detail = 1.0;      //! slider(0, 1) step(0.01)
                                 //! How much of the image's contrast is left. 0: its mean colour

// Of a plane: one texel's step east and one north, in tiles, and how fine the image is.
vec3 read_at(vec2 place, vec2 east, vec2 north) {
    float across = max(length(east), length(north)) * float(textureSize(colour, 0).x);
    // A whole level, as in texturing/tiled.
    return textureLod(colour, place, max(floor(log2(max(across, 1e-6)) + 0.5), 0.0)).rgb;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    vec2 slope = relief * slope_at(height, place, spacing_of(grid, extent), CENTRAL_DIFFERENCES);
    float tiles = repeats / extent.x;  // to the metre
    vec3 at = vec3(share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x),
                   tiles * relief * height_at(height, place));
    vec2 pitch = tiles * spacing;
    vec3 normal = normal_of_slope(slope);

    // The three planes' shares; on terrain that is not steep, the level plane's alone.
    vec3 weights = planes_of(normal, cliffs, sharpness);

    vec3 above = read_at(at.xy, vec2(pitch.x, 0.0), vec2(0.0, pitch.y));
    vec3 shown = above;
    vec3 mean = textureLod(colour, vec2(0.5), 99.0).rgb;
    if (weights.z < 1.0) {
        vec2 rise = pitch * slope;
        // Moved, or all three would show the same piece along the lines where they meet.
        vec3 facing_east = read_at(at.yz + vec2(0.37, 0.0), vec2(0.0, rise.x),
                                   vec2(pitch.y, rise.y));
        vec3 facing_north = read_at(at.xz + vec2(0.71, 0.0), vec2(pitch.x, rise.x),
                                    vec2(0.0, rise.y));
        shown = mixed_with_contrast(weights, facing_east, facing_north, above, mean);
    }
    return vec4(mix(mean, shown, detail), 1.0);
}
