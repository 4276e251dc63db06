// The ground of a part's own texels, interpolated only where the source is coarser: on a texel of
// the source the share is 0, and a + (b - a) 0 is a to the last bit. Alpha says how much of the
// light comes straight from the sun, as far as the sky's light is known.

uniform sampler2D source;
uniform float first;
uniform float rise;
uniform vec3 sky;  // the sky's light in the source
out vec4 ground;
void main() {
    vec2 place = first + rise * floor(gl_FragCoord.xy);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, textureSize(source, 0) - 1);
    vec2 share = place - vec2(low);
    vec3 a = texelFetch(source, low, 0).rgb, b = texelFetch(source, ivec2(high.x, low.y), 0).rgb;
    vec3 c = texelFetch(source, ivec2(low.x, high.y), 0).rgb, d = texelFetch(source, high, 0).rgb;
    vec3 south = a + (b - a) * share.x, north = c + (d - c) * share.x;
    vec3 light = south + (north - south) * share.y;
    vec3 bright = vec3(0.2126, 0.7152, 0.0722);
    ground = vec4(light, clamp(1.0 - dot(sky, bright) / max(dot(light, bright), 1e-6), 0.0, 1.0));
}
