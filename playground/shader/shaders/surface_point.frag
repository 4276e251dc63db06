#version 330
// The point of the terrain under a pixel: march along its ray, then halve the step that goes below.
uniform sampler2D height;
uniform vec3 start;  // [m] where the ray enters the terrain's bounds
uniform vec3 way;    // its unit vector
uniform float far;   // [m] along it to where it leaves
uniform int steps;
uniform vec2 extent;
uniform float relief;
out vec4 found;      // shares east and north, 1 where there is ground, its height

float ground(vec2 place) {
    ivec2 last = textureSize(height, 0) - 1;
    vec2 at = clamp(place / extent, 0.0, 1.0) * vec2(last);
    ivec2 low = min(ivec2(at), max(last - 1, 0)), high = min(low + 1, last);
    vec2 part = at - vec2(low);
    float south = mix(texelFetch(height, low, 0).r, texelFetch(height, ivec2(high.x, low.y), 0).r, part.x);
    float north = mix(texelFetch(height, ivec2(low.x, high.y), 0).r, texelFetch(height, high, 0).r, part.x);
    return mix(south, north, part.y);
}

bool below(float along) {
    vec3 place = start + along * way;
    return place.z <= ground(place.xy) * relief;
}

void main() {
    found = vec4(0.0);
    for (int n = 0; n <= steps; ++n) {
        float high = far * (float(n) / float(steps));
        if (!below(high)) continue;
        float low = far * (float(max(n - 1, 0)) / float(steps));
        for (int k = 0; k < 24; ++k) {
            float middle = 0.5 * (low + high);
            if (below(middle)) high = middle; else low = middle;
        }
        vec2 place = (start + high * way).xy;
        found = vec4(clamp(place / extent, 0.0, 1.0), 1.0, ground(place));
        return;
    }
}
