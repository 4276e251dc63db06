// Cells around points that drift: each pixel finds its nearest point by jumps (a pass of glslViewer's).
uniform vec2 u_resolution;
uniform float u_time;
uniform sampler2D u_flood0;
uniform float across = 8.0;  //! slider(2, 24) step(1) Points from west to east

float chance(vec2 at, float salt) {
    return fract(sin(dot(at, vec2(12.9898, 78.233)) + salt) * 43758.5453);
}

void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(FLOOD_0)
    vec2 square = floor(st * across);
    float turn = 6.2831853 * chance(square, 1.0) + u_time;
    vec2 point = (square + 0.5 + 0.35 * vec2(cos(turn), sin(turn))) / across;
    bool is_point = all(equal(floor(point * u_resolution), floor(gl_FragCoord.xy)));
    gl_FragColor = is_point ? vec4(st, 0.0, 0.0) : vec4(0.0);
#else
    vec2 nearest = texture2D(u_flood0, st).xy;
    float far = distance(nearest, st) * across * 1.125;
    vec3 tint = 0.5 + 0.5 * cos(6.2831853 * (nearest.x + nearest.y + vec3(0.0, 0.33, 0.67)));
    gl_FragColor = vec4(tint * (1.0 - 0.7 * far) + smoothstep(0.08, 0.04, far), 1.0);
#endif
}
