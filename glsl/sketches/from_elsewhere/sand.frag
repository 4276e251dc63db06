// Sand, as a shader for Shadertoy: iChannel0 has heights in red, and the colour follows them.
vec3 palette(float t) {
    return vec3(0.86, 0.66, 0.45) + vec3(0.12, 0.14, 0.16) * cos(6.2831853 * (t * vec3(1.0, 0.95, 0.9) + 0.52));
}

void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    ivec2 here = ivec2(fragCoord * iChannelResolution[0].xy / iResolution.xy);
    ivec2 last = ivec2(iChannelResolution[0].xy) - 1;
    float height = texelFetch(iChannel0, here, 0).r;
    float east = texelFetch(iChannel0, min(here + ivec2(1, 0), last), 0).r;
    float ripple = 0.5 + 0.5 * sin(400.0 * height);
    vec3 colour = palette(1.4 * height) * (0.94 + 0.06 * ripple);
    colour = mix(colour, vec3(0.55, 0.33, 0.22), clamp((height - east) * 30.0, 0.0, 0.6));
    fragColor = vec4(colour, 1.0);
}
