// A ramp's colours from its begin to its end; colour/ramp.glsl comes before.
uniform int ramp;
uniform float steps;
out vec4 colour;
void main() { colour = vec4(ramp_colour(ramp, (gl_FragCoord.x - 0.5) / (steps - 1.0)), 1.0); }
