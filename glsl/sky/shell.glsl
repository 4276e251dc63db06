// sky/shell.glsl -- straight paths through the air, which is a shell around a round Earth.
//
//   gives    EARTH_RADIUS, AIR_HEIGHT, height_along, distance_to_top, distance_to_ground,
//            horizon_rise
//   needs    nothing: pure functions, no uniforms, no textures
//   units    kilometres; `rise` is the cosine between a path and the vertical at its start
//   source   the law of cosines; derived here so that floats lose nothing
//   tested   tests/glsl/test_air.py, against float64
//
// Squares of the Earth's radius take all of a float's digits, and heights are differences of
// them. With d = 2 r rise path + path², the height after a path is h + d / (sqrt(r² + d) + r),
// in which nothing cancels; h (2 R + h) represents r² - R² likewise.
#ifndef SKY_SHELL
#define SKY_SHELL

const float EARTH_RADIUS = 6360.0;
const float AIR_HEIGHT = 100.0;

// The height that is reached after a path from a height.
float height_along(float height, float rise, float path) {
    float r = EARTH_RADIUS + height;
    float d = path * (2.0 * r * rise + path);
    return height + d / (sqrt(max(r * r + d, 0.0)) + r);
}

// How far it is to the top of the air; the ground is looked through.
float distance_to_top(float height, float rise) {
    float along = (EARTH_RADIUS + height) * rise;
    float above = (AIR_HEIGHT - height) * (2.0 * EARTH_RADIUS + AIR_HEIGHT + height);
    return max(sqrt(max(above + along * along, 0.0)) - along, 0.0);
}

// How far it is to the ground, or -1 where the path misses it.
float distance_to_ground(float height, float rise) {
    float along = (EARTH_RADIUS + height) * rise;
    float left = along * along - height * (2.0 * EARTH_RADIUS + height);
    return rise < 0.0 && left >= 0.0 ? max(-along - sqrt(left), 0.0) : -1.0;
}

// The rise of the path from a height to the horizon: 0 on the ground, less above it.
float horizon_rise(float height) {
    return -sqrt(max(height * (2.0 * EARTH_RADIUS + height), 0.0)) / (EARTH_RADIUS + height);
}
#endif
