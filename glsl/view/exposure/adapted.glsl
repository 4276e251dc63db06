// view/exposure/adapted.glsl -- by how many stops a picture is to be exposed.
//
//   gives    adapted: stops, and 1; zeros where the picture does not say
//   needs    blocks of view/exposure/blocks
//   units    stops: powers of two
//   source   Reinhard, Stark, Shirley and Ferwerda 2002, "Photographic Tone Reproduction for
//            Digital Images" (SIGGRAPH), eqs 1 and 2: the key over the mean of logarithms
//   tested   tests/glsl/test_after.py, against NumPy in float64
#pragma kernel(output = "adapted:rg32f", repeat = "1 if adapts else 0")

uniform sampler2D blocks;  //! input
#include "view/parameters/adapts.glsl"
uniform float key = 0.18;    //! log_slider(0.02, 1) group("Picture")
                             //! Light that the mean is brought to: 0.18 is a grey card, less is
                             //! a night
uniform float minimum = -6.0;  //! slider(-16, 0) step(0.1) unit("stops") group("Picture")
                             //! No picture is darkened more
uniform float maximum = 6.0;  //! slider(0, 16) step(0.1) unit("stops") group("Picture")
                             //! No picture is brightened more

vec2 kernel(ivec2 texel) {
    ivec2 many = textureSize(blocks, 0);
    vec2 total = vec2(0.0);
    for (int y = 0; y < many.y; y++) {
        for (int x = 0; x < many.x; x++) total += texelFetch(blocks, ivec2(x, y), 0).rg;
    }
    return vec2(clamp(log2(key) - total.x / total.y, minimum, maximum), 1.0);
}
