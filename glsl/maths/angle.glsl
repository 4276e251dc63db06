// maths/angle.glsl -- cosine and sine of an angle in degrees, exact at quarter turns.
//
//   gives    cos_sin_degrees
//   needs    nothing: pure functions, no uniforms, no textures
//   units    degrees in; cosine and sine out
//   source   derived here: an angle is a whole number of quarter turns and a rest within 45
//            degrees
//   tested   tests/glsl/test_maths.py, against Python's own in float64
//
// The radians of 90 degrees are no float, so cos(radians(90.0)) is -4e-8, and a sun in the
// zenith would lean. Taking quarter turns out first leaves 0 and 1 exact, and makes turned
// and mirrored directions turned and mirrored to the last bit.
#ifndef MATHS_ANGLE
#define MATHS_ANGLE

vec2 cos_sin_degrees(float angle) {
    float turns = floor(angle / 90.0 + 0.5);
    float rest = radians(angle - 90.0 * turns);
    float c = cos(rest);
    float s = sin(rest);
    int quarter = int(turns) & 3;
    vec2 turned = (quarter & 1) == 0 ? vec2(c, s) : vec2(-s, c);
    return quarter < 2 ? turned : -turned;
}
#endif
