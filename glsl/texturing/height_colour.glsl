// texturing/height_colour.glsl -- a colour for every vertex, by its height alone.
//
//   gives    colour, linear light
//   needs    terrain/heightfield.glsl; a height 0..1
//   units    levels in greys, 0 to 255, as the thresholds of texturing/height_blend
//   source   Belaiche 2010, section 2.3, the "first solution"; layer tints of maps
//   tested   tests/glsl/test_texturing_height_colour.py, against interpolation in NumPy
//
// The thesis finds this poor, and it is: no matter how near one comes, there is nothing more
// to see. Between the stops the colour changes evenly, in linear light. Give this pass as many
// texels a side as the view's mesh has vertices, and the colours are the vertices' own, the
// ground between them interpolated.
#include "terrain/heightfield.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;  //! input

uniform vec3 low = vec3(0.050, 0.130, 0.030);     //! colour group("Colours")
                                                  //! At the lowest level and below
uniform vec3 middle = vec3(0.300, 0.290, 0.100);  //! colour group("Colours") At the second
uniform vec3 high = vec3(0.230, 0.140, 0.080);    //! colour group("Colours") At the third
uniform vec3 top = vec3(0.850, 0.870, 0.900);     //! colour group("Colours")
                                                  //! At the highest level and above
uniform vec4 levels = vec4(20.0, 95.0, 165.0, 225.0);  //! slider(0, 255) step(1) group("Heights")
                                                       //! The height of each colour, at least
                                                       //! that of the one before
uniform bool bands = false;  //! group("Heights")
                             //! One colour from each level to the next, as on a map, instead of
                             //! passing from one to the other

// 0 below `from`, 1 from `to` up, between them even; a step where they are the same or out of
// order.
float risen(float level, float from, float to) {
    if (bands) return level >= to ? 1.0 : 0.0;
    return level >= to ? 1.0 : clamp((level - from) / max(to - from, 1e-6), 0.0, 1.0);
}

vec4 kernel(ivec2 texel) {
    float level = 255.0 * height_at(height, place_on(textureSize(height, 0), texel, size));
    // Terrain that is not a number stays visible as such in view/land.
    if (isnan(level)) level = 0.0;
    vec3 colour = mix(low, middle, risen(level, levels.x, levels.y));
    colour = mix(colour, high, risen(level, levels.y, levels.z));
    colour = mix(colour, top, risen(level, levels.z, levels.w));
    return vec4(colour, 1.0);
}
