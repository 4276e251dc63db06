// erosion/strata.glsl -- how hard the rock is that comes to light: layers, tilted and folded.
//
//   gives    hardness, 1 for the reference rock, 2 for rock that wears half as fast
//   needs    maths/land.glsl, noise/hash.glsl, noise/periodic.glsl, terrain/heightfield.glsl; a
//            height
//   units    metres, degrees
//   source   layers as in Beneš and Forsbach 2001, "Layered Data Representation for Visual
//            Simulation of Terrain Erosion" (SCCG), but endless and given by a formula
//   tested   tests/glsl/test_strata.py, along and across the layers
//
// Hard and soft layers alternate, each by an amount of its own. What erosion lays bare is another
// layer: run it some steps, take the hardness of what is left, and run it again.
#include "noise/hash.glsl"
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "hardness:r32f", relief = "true")

uniform sampler2D height;  //! input

uniform float thickness = 120.0;  //! log_slider(1, 5000) unit("m") How thick a layer is
uniform float contrast = 3.0;     //! log_slider(1, 100)
                                  //! How much harder the hardest rock is than the reference, and
                                  //! how much softer the softest
uniform vec2 dip = vec2(90.0, 6.0);  //! direction Where the layers lead down, and how steeply
uniform float folds = 40.0;       //! slider(0, 1000) step(1) unit("m")
                                  //! How far they bend up and down
uniform float fold_width = 3000.0;  //! log_slider(10, 100000) unit("m") From one fold to the next
uniform float blend = 0.15;       //! slider(0.01, 1) step(0.01)
                                  //! The share of a layer over which it becomes the next
uniform uint seed = 1u;           //! slider(0, 9999) Which layers

const uint SALT = 0x14f611a8u;  // CRC-32 of "erosion/strata"

// From -1, the softest, to 1, the hardest.
float character(int layer) {
    float strength = 0.4 + 0.6 * random(ivec2(layer, 0), seed + SALT);
    return (layer & 1) == 0 ? strength : -strength;
}

float kernel(ivec2 texel) {
    vec2 place = share_of_texel(texel, size) * extent;
    float level = relief * height_at(height, place_on(textureSize(height, 0), texel, size));
    // A layer that leads down to the east has at one level risen as far, further east.
    vec3 down = towards_dip;
    level += dot(place - 0.5 * extent, down.xy) * down.z / max(dot(down.xy, down.xy), 1e-4);
    if (folds > 0.0) {
        level += folds * gradient_fbm_periodic(place / fold_width, ivec2(1 << 20), 3, 0.5,
                                               seed + SALT + 1u);
    }
    float through = level / thickness;
    int layer = int(floor(through));
    float part = clamp((through - float(layer) - 1.0 + blend) / blend, 0.0, 1.0);
    float soft_to_hard = mix(character(layer), character(layer + 1), part);
    return exp2(log2(contrast) * soft_to_hard);
}
