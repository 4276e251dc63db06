// Hills of six octaves, each turned against the one before; the channels are four terrains.
uniform uint seed = 0u;
vec4 kernel(ivec2 texel) {
    vec2 place = vec2(texel) / vec2(max(size - 1, ivec2(1)));
    vec4 sum = vec4(0.5);
    for (int octave = 0; octave < 6; octave++) {
        float angle = 1.7 * float(octave) + float(seed);
        float share = exp2(float(octave));
        vec2 way = vec2(cos(angle), sin(angle)) * 4.0 * share;
        vec4 along = vec4(dot(place, way) + angle) + vec4(0.0, 1.0, 2.0, 3.0);
        float across = dot(place, vec2(-way.y, way.x)) * 1.3;
        sum += 0.24 / share * sin(along) * cos(across + angle);
    }
    return clamp(sum, 0.0, 1.0);
}
