// scene/water/heaven_reading.glsl -- where in the table of scene/water/heaven a direction is.
//
//   gives    THIN_CLOUD, THICK_CLOUD, share_of_thick, SKIES, CLEAR_SKY, THIN_SKY, THICK_SKY,
//            heaven_direction, heaven_place
//   needs    nothing: pure functions; the table is read "linear", "repeat"
//   units    unit vectors, x east, y north, z up; thickness of clouds as a share of the thickest
//   source   none: made here
//   tested   tests/glsl/test_scene_water.py: there and back
#ifndef SCENE_WATER_HEAVEN_READING
#define SCENE_WATER_HEAVEN_READING

const float THIN_CLOUD = 0.08;
const float THICK_CLOUD = 0.9;

// How much of the second in a cloud between both: light goes about as one over a cloud's depth.
float share_of_thick(float thickness) {
    vec3 reciprocal = 1.0 / (0.15 + vec3(clamp(thickness, THIN_CLOUD, THICK_CLOUD), THIN_CLOUD,
                                      THICK_CLOUD));
    return (reciprocal.y - reciprocal.x) / (reciprocal.y - reciprocal.z);
}

// Three skies, one over the other in the table.
const int SKIES = 3;
const int CLEAR_SKY = 0;
const int THIN_SKY = 1;
const int THICK_SKY = 2;

// Of a texel of one of them, so many texels wide and high.
vec3 heaven_direction(ivec2 texel, ivec2 table) {
    float turn = 6.2831853 * (float(texel.x) + 0.5) / float(table.x);
    float root = (float(texel.y) + 0.5) / float(table.y);
    float up = root * root;
    return vec3(sqrt(1.0 - up * up) * vec2(sin(turn), cos(turn)), up);
}

// The place of a direction in the texture, in one of its skies.
vec2 heaven_place(vec3 towards, int which, ivec2 texture_texels) {
    // Straight up has no azimuth: any will do.
    bool upright = towards.x == 0.0 && towards.y == 0.0;
    float turn = upright ? 0.0 : atan(towards.x, towards.y) / 6.2831853;
    float half_row = 0.5 * float(SKIES) / float(texture_texels.y);
    float row = clamp(sqrt(max(towards.z, 0.0)), half_row, 1.0 - half_row);
    return vec2(turn, (float(which) + row) / float(SKIES));
}
#endif
