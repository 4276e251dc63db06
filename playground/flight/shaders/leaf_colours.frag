// The mean colours of a wood on a day: of broad leaves, and of needles.
#include "trees/crown.glsl"

uniform float day;
out vec4 colour;
void main() {
    vec4 others = gl_FragCoord.x < 1.0 ? ALL_LEAVES : ALL_NEEDLES;
    vec3 total = vec3(0.0);
    for (int k = 0; k < SPECIES * TINTS; k++) {
        float tint = (float(k % TINTS) + 0.5) / float(TINTS);
        total += share_in_sight(others, k / TINTS) / float(TINTS) * tree_colour(k / TINTS, tint, 0.0, day);
    }
    colour = vec4(total, 1.0);
}
