// Dunes, as a shader of one pass for Shadertoy: the red channel is a height.
// Crests lie across the wind; a slower wave bends them, and small ones ride on large ones.
uniform float wind; // -3..3, the direction that the crests lie across, in radians

float random(ivec2 cell) {
    uint key = uint(cell.x) * 0x9e3779b1u ^ uint(cell.y) * 0x85ebca77u;
    key = (key ^ (key >> 15u)) * 0x7feb352du;
    key = (key ^ (key >> 13u)) * 0x846ca68bu;
    return float((key ^ (key >> 16u)) >> 8u) / 16777216.0;
}

float noise(vec2 place) {
    vec2 cell = floor(place), t = place - cell;
    t = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    ivec2 c = ivec2(cell);
    vec2 row = mix(vec2(random(c), random(c + ivec2(0, 1))),
                   vec2(random(c + ivec2(1, 0)), random(c + ivec2(1, 1))), t.x);
    return mix(row.x, row.y, t.y);
}

// A wave that rises slowly and falls steeply, as sand does: 0..1.
float dune(float phase) {
    float t = fract(phase);
    float slope = t < 0.68 ? t / 0.68 : (1.0 - t) / 0.32;
    return slope * slope * (3.0 - 2.0 * slope);
}

void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 place = fragCoord / iResolution.xy;
    float angle = 0.5 + wind;
    vec2 turned = mat2(cos(angle), sin(angle), -sin(angle), cos(angle)) * place;
    float bend = noise(turned * vec2(2.0, 3.0)) + 0.5 * noise(turned * vec2(5.0, 9.0) + 7.0);
    float height = 0.5 * dune(turned.x * 5.0 + 1.3 * bend) * (0.45 + 0.55 * noise(turned * 4.0 + 3.0));
    height += 0.1 * dune(turned.x * 17.0 + 2.2 * bend + 0.3 * noise(turned * 16.0))
                   * noise(turned * 7.0 + 11.0);
    height += 0.3 * noise(place * 1.7 + 19.0);
    fragColor = vec4(vec3(height), 1.0);
}
