// The heights at a part's own nodes, cut out of its texture with the apron.

uniform sampler2D source;
uniform int apron;
out float height;
void main() { height = texelFetch(source, ivec2(gl_FragCoord.xy) + apron, 0).r; }
