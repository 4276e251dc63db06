// The colours of a wood on a day: of broad leaves, and of needles.
#include "trees/kinds.glsl"

uniform float day;
out vec4 colour;
void main() { colour = vec4(mean_leaf_colour(floor(gl_FragCoord.x), day), 1.0); }
