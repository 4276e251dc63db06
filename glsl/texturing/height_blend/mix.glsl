// texturing/height_blend/mix.glsl -- one texture for the terrain from three, chosen by height.
//
//   gives    colour, linear light
//   needs    maths/land.glsl, texturing/height_weights.glsl; a height 0..1, and three
//            colours for the whole terrain, each of any size
//   units    thresholds in grey levels, 0 to 255, as the thesis has them; above 255, never
//   source   Belaiche 2010, sections 2.3.1 to 2.3.3
//   tested   tests/glsl/test_height_blend.py, against the thesis's function in NumPy
//
// rgba16f: linear light in 8 bits leaves 13 steps below the grass's mean.
#include "maths/land.glsl"
#include "texturing/height_weights.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;  //! input
uniform sampler2D grass;   //! input
uniform sampler2D rock;    //! input
uniform sampler2D snow;    //! input

uniform float grass_below = 60.0;  //! slider(0, 300) step(1) group("Heights")
                                   //! Nothing but grass below this grey level
uniform float rock_from = 130.0;   //! slider(0, 300) step(1) group("Heights")
                                   //! No grass from here up
uniform float rock_below = 180.0;  //! slider(0, 300) step(1) group("Heights") No snow below this
uniform float snow_from = 220.0;   //! slider(0, 300) step(1) group("Heights")
                                   //! Nothing but snow from here up

vec4 nearest(sampler2D field, ivec2 texel) {
    return texelFetch(field, ivec2(place_on(textureSize(field, 0), texel, size) + 0.5), 0);
}

vec4 kernel(ivec2 texel) {
    float level = nearest(height, texel).r * 255.0;
    // Terrain that is not a number stays visible as such in view/land.
    if (isnan(level)) level = 0.0;
    // anchor: mixed
    vec3 weights = height_weights(level, vec4(grass_below, rock_from, rock_below, snow_from));
    vec3 mixed = weights.x * nearest(grass, texel).rgb
               + weights.y * nearest(rock, texel).rgb
               + weights.z * nearest(snow, texel).rgb;
    // end: mixed
    return vec4(mixed, 1.0);
}
