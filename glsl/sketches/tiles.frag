// Six channels side by side: an image, a film and noise; a test card and two sounds.
uniform vec2 u_resolution;
uniform sampler2D photo;
uniform sampler2D film;
uniform sampler2D grain;
uniform sampler2D card;
uniform sampler2D band;
uniform sampler2D tones;

vec3 heard(sampler2D channel, vec2 at) {
    float strength = texture2D(channel, vec2(at.x * 0.5, 0.25)).r;
    float wave = texture2D(channel, vec2(at.x, 0.75)).r;
    vec3 colour = at.y < 0.6 * strength ? vec3(0.2 + at.y, 0.5, 0.9 - at.x) : vec3(0.08, 0.09, 0.12);
    return abs(at.y - wave) < 0.015 ? vec3(1.0) : colour;
}

void main() {
    vec2 at = gl_FragCoord.xy / u_resolution * vec2(3.0, 2.0);
    vec2 tile = floor(at);
    at -= tile;
    vec3 colour = heard(tones, at);
    if (tile.y > 0.5) {
        colour = tile.x < 0.5 ? texture2D(photo, at).rgb
               : tile.x < 1.5 ? texture2D(film, at).rgb : texture2D(grain, at).rgb;
    } else if (tile.x < 1.5) {
        colour = tile.x < 0.5 ? texture2D(card, at).rgb : heard(band, at);
    }
    gl_FragColor = vec4(colour, 1.0);
}
