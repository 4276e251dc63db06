// scene/water/heaven_reading.glsl -- where in the table of scene/water/heaven a direction is.
//
//   gives    THIN_CLOUD, THICK_CLOUD, heaven_direction, heaven_place
//   needs    nothing: pure functions; the tables are read "linear", "repeat"
//   units    unit vectors, x east, y north, z up; thickness of clouds as a share of the thickest
//   source   none: made here
//   tested   tests/glsl/test_scene_water.py: there and back
#ifndef SCENE_WATER_HEAVEN_READING
#define SCENE_WATER_HEAVEN_READING

const float THIN_CLOUD = 0.08;
const float THICK_CLOUD = 0.6;

vec3 heaven_direction(ivec2 texel, ivec2 table) {
    float turn = 6.2831853 * (float(texel.x) + 0.5) / float(table.x);
    float root = (float(texel.y) + 0.5) / float(table.y);
    float up = root * root;
    return vec3(sqrt(1.0 - up * up) * vec2(sin(turn), cos(turn)), up);
}

vec2 heaven_place(vec3 towards, ivec2 table) {
    float turn = atan(towards.x, towards.y) / 6.2831853;
    float half_row = 0.5 / float(table.y);
    return vec2(turn, clamp(sqrt(max(towards.z, 0.0)), half_row, 1.0 - half_row));
}
#endif
