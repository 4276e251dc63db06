// trees/wood_reading.glsl -- where in the table of a wood's light a direction and a density are.
//
//   gives    DENSITIES, MIXES, LOWEST, axes_of, height_on_axis, direction_of, wood_at
//   needs    the table of trees/wood.glsl as an argument
//   units    unit vectors; density 0..1
//   source   made here: steps of the root of the sine are finer towards the horizon
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_WOOD_READING
#define TREES_WOOD_READING

const int DENSITIES = 5;
const int MIXES = 2;  // of the lowland's mix of species, of needles only
const float LOWEST = 0.02;  // sine of the lowest elevation

// Elevations, azimuths, densities.
ivec3 axes_of(ivec2 size) {
    return ivec3(size.x, max(size.y / (DENSITIES * MIXES), 1), DENSITIES);
}

float height_on_axis(vec3 towards) {
    return (sqrt(clamp(towards.z, LOWEST, 1.0)) - sqrt(LOWEST)) / (1.0 - sqrt(LOWEST));
}

// `aside`: 0 on the sun's side, 1 opposite.
vec3 direction_of(float height, float aside) {
    float root = mix(sqrt(LOWEST), 1.0, height);
    float sine = root * root;
    float turn = 3.14159265 * aside;
    return vec3(sqrt(max(1.0 - sine * sine, 0.0)) * vec2(cos(turn), sin(turn)), sine);
}

vec2 texel_between(sampler2D table, vec2 at, int low) {
    ivec2 from = ivec2(at);
    vec2 part = at - vec2(from);
    ivec2 to = min(from + 1, ivec2(textureSize(table, 0).x, axes_of(textureSize(table, 0)).y) - 1);
    vec2 south = mix(texelFetch(table, ivec2(from.x, low + from.y), 0).rg,
                     texelFetch(table, ivec2(to.x, low + from.y), 0).rg, part.x);
    vec2 north = mix(texelFetch(table, ivec2(from.x, low + to.y), 0).rg,
                     texelFetch(table, ivec2(to.x, low + to.y), 0).rg, part.x);
    return mix(south, north, part.y);
}

// `only`: how far from the lowland's mix of species to needles only, 0..1 (needles_only).
vec2 wood_at(sampler2D table, vec3 to_eye, vec3 to_sun, float density, float only) {
    ivec3 axes = axes_of(textureSize(table, 0));
    float lengths = max(length(to_eye.xy) * length(to_sun.xy), 1e-6);
    float aside = acos(clamp(dot(to_eye.xy, to_sun.xy) / lengths, -1.0, 1.0)) / 3.14159265;
    vec3 at = vec3(height_on_axis(to_eye), aside, clamp(density, 0.0, 1.0)) * vec3(axes - 1);
    int layer = min(int(at.z), axes.z - 2);
    vec2 lit = vec2(0.0);
    for (int k = 0; k < MIXES; k++) {
        float weight = k == 0 ? 1.0 - only : only;
        if (weight <= 0.0) continue;
        int low = (k * axes.z + layer) * axes.y;
        vec2 thin = texel_between(table, at.xy, low);
        vec2 thick = texel_between(table, at.xy, low + axes.y);
        lit += weight * mix(thin, thick, at.z - float(layer));
    }
    return lit;
}
#endif
