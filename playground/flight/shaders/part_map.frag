// One number of a part's own texels, 0..1, cut out of a map of it and its apron.
#include "terrain/heightfield.glsl"

uniform sampler2D source;
uniform float first;
uniform float rise;
out vec4 found;
void main() {
    vec2 place = first + rise * floor(gl_FragCoord.xy);
    found = vec4(clamp(height_at(source, place), 0.0, 1.0));
}
