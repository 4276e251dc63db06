// The mean colours of a wood on a day: of broad leaves, and of needles.
#include "trees/crown.glsl"

uniform float day;
out vec4 colour;
void main() {
    vec4 others = gl_FragCoord.x < 1.0 ? ALL_LEAVES : ALL_NEEDLES;
    vec4 in_sight = others_in_sight(others);
    int species[5] = int[5](OAK, MAPLE, BIRCH, PINE, SPRUCE);
    float shares[5] = float[5](share_of_oaks(in_sight), in_sight.x, in_sight.y, in_sight.z,
                               in_sight.w);
    vec3 total = vec3(0.0);
    for (int k = 0; k < 5 * TINTS; k++) {
        float tint = (float(k % TINTS) + 0.5) / float(TINTS);
        total += shares[k / TINTS] / float(TINTS) * tree_colour(species[k / TINTS], tint, 0.0, day);
    }
    colour = vec4(total, 1.0);
}
