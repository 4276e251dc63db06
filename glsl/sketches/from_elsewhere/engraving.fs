/*{
  "ISFVSN": "2",
  "DESCRIPTION": "A picture as an engraving: lines that swell where it is dark.",
  "CATEGORIES": ["Filter"],
  "INPUTS": [
    {"NAME": "inputImage", "TYPE": "image"},
    {"NAME": "pitch", "TYPE": "float", "MIN": 2.0, "MAX": 16.0, "DEFAULT": 4.0, "LABEL": "Line spacing"},
    {"NAME": "ink", "TYPE": "color", "DEFAULT": [0.13, 0.10, 0.16, 1.0]},
    {"NAME": "paper", "TYPE": "color", "DEFAULT": [0.96, 0.93, 0.86, 1.0]},
    {"NAME": "wash", "TYPE": "float", "MIN": 0.0, "MAX": 1.0, "DEFAULT": 0.8, "LABEL": "Colour kept"}
  ]
}*/
float distance_to_line(vec2 pixel, float angle) {
    float across = dot(pixel, vec2(cos(angle), sin(angle))) / pitch;
    return 2.0 * abs(fract(across) - 0.5);
}

float line(vec2 pixel, float angle, float darkness) {
    float edge = 1.5 / pitch;
    return smoothstep(1.0 - darkness - edge, 1.0 - darkness + edge, distance_to_line(pixel, angle));
}

void main() {
    vec4 picture = IMG_THIS_PIXEL(inputImage);
    float darkness = clamp(1.1 - 1.45 * dot(picture.rgb, vec3(0.2126, 0.7152, 0.0722)), 0.0, 1.0);
    float drawn = max(line(gl_FragCoord.xy, 0.9, darkness), line(gl_FragCoord.xy, -0.5, 1.7 * darkness - 0.85));
    vec3 ground = mix(paper.rgb, paper.rgb * (0.25 + 0.85 * picture.rgb), wash);
    gl_FragColor = vec4(mix(ground, ink.rgb, 0.9 * drawn), 1.0);
}
