// A square over the whole picture, for draws over the pixels of another.
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(2.0 * corner.xy - 1.0, 0.0, 1.0);
}
vec4 fragment(vec2 place) { return vec4(place, 1.0, 0.5); }
