"""Lands that several tests of light stand on."""

# Hills of four sizes, turned or mirrored when asked to.
HILLS = """
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")
uniform float scale = 1.0;
uniform float base = 0.0;
uniform int turned = 0;   //! menu("no", "quarter", "mirrored")
float value(ivec2 texel) {
    float total = 0.0;
    for (int k = 0; k < 4; k++) {
        float cell = float(16 >> k);
        vec2 place = vec2(texel) / cell;
        ivec2 low = ivec2(place);
        vec2 part = place - vec2(low);
        part = part * part * (3.0 - 2.0 * part);
        float south = mix(random(low, uint(k)), random(low + ivec2(1, 0), uint(k)), part.x);
        float north = mix(random(low + ivec2(0, 1), uint(k)), random(low + 1, uint(k)), part.x);
        total += mix(south, north, part.y) * cell / 30.0;
    }
    return total;
}
float kernel(ivec2 texel) {
    ivec2 from = texel;
    if (turned == 1) from = ivec2(texel.y, size.x - 1 - texel.x);
    if (turned == 2) from.x = size.x - 1 - texel.x;
    return base + scale * value(from);
}
"""
