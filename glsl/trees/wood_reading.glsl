// trees/wood_reading.glsl -- the light on a wood, out of the table of trees/wood.
//
//   gives    DEPTHS, SHAPES, LOWEST, axes_of, direction_of, depth_on_axis, Depths, wood_at
//   needs    the table of trees/wood.glsl as an argument
//   units    unit vectors; depths as of depth_towards (trees/stand.glsl)
//   source   made here: steps of the root of the sine are finer towards the horizon, steps of
//            d / (d + 3) finer where a wood is thin
//   tested   tests/glsl/test_trees_light.py
//
// What one sees of a wood of the depth d is there exp(-d share) times as often, where `share` of
// the crowns is above, and as much of the sun is left as exp(-e share) says: so the mean light is
// the quotient of the sums at d + e and at d. Where the ground slopes, or trees stand thinner,
// only these depths differ.
#ifndef TREES_WOOD_READING
#define TREES_WOOD_READING

const int DEPTHS = 12;
const int SHAPES = 2;  // of broad leaves, of needles
const float LOWEST = 0.02;  // sine of the lowest elevation
const float MIDDLE_DEPTH = 3.0;
const float END_OF_DEPTHS = 0.985;  // on the axis: a depth of 197

// Elevations, azimuths, depths.
ivec3 axes_of(ivec2 size) {
    return ivec3(size.x, max(size.y / (DEPTHS * SHAPES), 1), DEPTHS);
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

float depth_on_axis(float share) {
    return MIDDLE_DEPTH * END_OF_DEPTHS * share / (1.0 - END_OF_DEPTHS * share);
}

float axis_of_depth(float depth) {
    return min(depth / (depth + MIDDLE_DEPTH) / END_OF_DEPTHS, 1.0);
}

// Towards the eye, the sun and the sky. (Not named eye: what names the camera follows it.)
struct Depths {
    float sight;
    float sun;
    float sky;
};

vec3 along_row(sampler2D table, float x, int row) {
    int low = int(x);
    int high = min(low + 1, textureSize(table, 0).x - 1);
    return mix(texelFetch(table, ivec2(low, row), 0).rgb,
               texelFetch(table, ivec2(high, row), 0).rgb, x - float(low));
}

vec3 sums_at(sampler2D table, int shape, vec2 at, float depth) {
    ivec3 axes = axes_of(textureSize(table, 0));
    float layer = axis_of_depth(depth) * float(DEPTHS - 1);
    int below = min(int(layer), DEPTHS - 2);
    int aside = int(at.y);
    int next = min(aside + 1, axes.y - 1);
    int row = (shape * DEPTHS + below) * axes.y;
    vec3 thin = along_row(table, at.x, row + aside);
    vec3 deep = along_row(table, at.x, row + axes.y + aside);
    if (at.y > float(aside)) {
        thin = mix(thin, along_row(table, at.x, row + next), at.y - float(aside));
        deep = mix(deep, along_row(table, at.x, row + axes.y + next), at.y - float(aside));
    }
    return mix(thin, deep, layer - float(below)) / (1.0 + depth);
}

// Sun and sky on what one sees of a wood of which so much is needles.
vec2 wood_at(sampler2D table, vec3 to_eye, vec3 to_sun, Depths depths, float needled) {
    ivec3 axes = axes_of(textureSize(table, 0));
    float lengths = max(length(to_eye.xy) * length(to_sun.xy), 1e-6);
    float aside = acos(clamp(dot(to_eye.xy, to_sun.xy) / lengths, -1.0, 1.0)) / 3.14159265;
    vec2 at = vec2(height_on_axis(to_eye), aside) * vec2(axes.xy - 1);
    vec3 total = vec3(0.0);
    for (int k = 0; k < SHAPES; k++) {
        float part = k == 0 ? 1.0 - needled : needled;
        if (part <= 0.0) continue;
        // Neither the sky nor how often a place is seen knows of the sun's side.
        total += part * vec3(sums_at(table, k, at, depths.sight + depths.sun).x,
                             sums_at(table, k, vec2(at.x, 0.0), depths.sight + depths.sky).y,
                             sums_at(table, k, vec2(at.x, 0.0), depths.sight).z);
    }
    return total.xy / total.z;
}
#endif
