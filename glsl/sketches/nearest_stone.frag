// A wall of stones, each coloured by the seed that is nearest: a flood finds it in a few jumps.
// Written as glslViewer reads it: the text is drawn once with FLOOD_0 defined, which sows the
// seeds, and once without, which reads from the flood where the nearest one is.
uniform vec2 u_resolution;
uniform float u_time;
uniform float u_mortar;     //! slider(0, 20) unit("px") Width of the joints
uniform sampler2D u_flood0;

const float ACROSS = 9.0;   // cells from west to east

float random_at(vec2 cell) {
    uint n = uint(int(cell.x) + 71) * 374761393u + uint(int(cell.y) + 71) * 668265263u;
    n = (n ^ (n >> 13)) * 1274126177u;
    return float((n ^ (n >> 16)) & 65535u) / 65535.0;
}

vec2 seed_in(vec2 cell) {
    float turn = 6.2831853 * random_at(cell) + u_time * (0.3 + 0.4 * random_at(cell.yx + 37.0));
    return cell + 0.5 + 0.36 * vec2(cos(turn), sin(turn));
}

void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    float side = u_resolution.x / ACROSS;  // [px] of a cell
#if defined(FLOOD_0)
    vec2 cell = floor(gl_FragCoord.xy / side);
    bool is_seed = floor(seed_in(cell) * side) == floor(gl_FragCoord.xy);
    gl_FragColor = is_seed ? vec4(st, 0.0, 1.0) : vec4(0.0);
#else
    vec2 nearest = texture(u_flood0, st).xy;
    vec2 cell = floor(nearest * u_resolution / side);
    float joint = 0.0;
    for (int i = 0; i < 8; ++i) {
        float turn = 0.78539816 * float(i);
        vec2 aside = gl_FragCoord.xy + 0.5 * u_mortar * vec2(cos(turn), sin(turn));
        aside = clamp(aside, vec2(0.5), u_resolution - 0.5);
        vec2 other = texture(u_flood0, aside / u_resolution).xy;
        joint += any(greaterThan(abs(other - nearest) * u_resolution, vec2(1.0))) ? 0.125 : 0.0;
    }
    float rise = 1.0 - 0.55 * distance(nearest * u_resolution, gl_FragCoord.xy) / side;
    vec3 stone = mix(vec3(0.36, 0.33, 0.31), vec3(0.66, 0.60, 0.52), random_at(cell + 5.0));
    gl_FragColor = vec4(mix(stone * rise, vec3(0.15, 0.14, 0.13), joint), 1.0);
#endif
}
