// Eight channels side by side: an image, a film, noise, a test card, two sounds, a sky and the keyboard.
uniform vec2 u_resolution;
uniform sampler2D photo;
uniform sampler2D film;
uniform sampler2D grain;
uniform sampler2D card;
uniform sampler2D band;
uniform sampler2D tones;
uniform samplerCube around;
uniform sampler2D typed;

vec3 heard(sampler2D channel, vec2 at) {
    float strength = texture2D(channel, vec2(at.x * 0.5, 0.25)).r;
    float wave = texture2D(channel, vec2(at.x, 0.75)).r;
    vec3 colour = at.y < 0.6 * strength ? vec3(0.2 + at.y, 0.5, 0.9 - at.x) : vec3(0.08, 0.09, 0.12);
    return abs(at.y - wave) < 0.015 ? vec3(1.0) : colour;
}

vec3 seen(vec2 at) {
    float azimuth = 6.2831853 * at.x, elevation = 3.1415927 * (at.y - 0.5);
    vec3 direction = vec3(cos(azimuth) * cos(elevation), sin(elevation), sin(azimuth) * cos(elevation));
    return textureCube(around, direction).rgb;
}

vec3 keys(vec2 at) {
    vec2 key = fract(at * vec2(32.0, 24.0));
    float column = floor(at.x * 32.0) + 32.0 * floor(fract(at.y * 3.0) * 8.0);
    float down = texture2D(typed, vec2((column + 0.5) / 256.0, (floor(at.y * 3.0) + 0.5) / 3.0)).r;
    float inside = step(0.15, key.x) * step(0.15, key.y);
    return mix(vec3(0.08, 0.09, 0.12), mix(vec3(0.2, 0.22, 0.28), vec3(1.0, 0.7, 0.2), down), inside);
}

void main() {
    vec2 at = gl_FragCoord.xy / u_resolution * vec2(4.0, 2.0);
    vec2 tile = floor(at);
    at -= tile;
    vec3 colour = keys(at);
    if (tile.y > 0.5) {
        colour = tile.x < 0.5 ? texture2D(photo, at).rgb : tile.x < 1.5 ? texture2D(film, at).rgb
               : tile.x < 2.5 ? texture2D(grain, at).rgb : seen(at);
    } else if (tile.x < 2.5) {
        colour = tile.x < 0.5 ? texture2D(card, at).rgb : tile.x < 1.5 ? heard(band, at) : heard(tones, at);
    }
    gl_FragColor = vec4(colour, 1.0);
}
