// lighting/horizon_sun/arc.glsl -- the horizons that a sun is between, and how much of it is seen.
//
//   gives    ARC, EIGHT, directions_for, Between, between_horizons, elevation_of, in_diameters,
//            disc_seen
//   needs    maths/angle.glsl
//   units    degrees; azimuths clockwise from north; unit vectors with x east, y north, z up
//   source   Belaiche 2010, section 3.4, eqs 3.5, 3.6 and 3.8, after Hoffman and Mitchell 2001,
//            "Real-Time Photorealistic Terrain Lighting"; between eight horizons: Max 1988,
//            "Horizon Mapping: Shadows for Bump-Mapped Surfaces"
//   tested   tests/glsl/test_analytic.py, against float64
//
// The thesis has the sun rise in one direction, go through the zenith and set in the opposite
// one: two horizons a texel are enough. The arc is under the sun unless an azimuth is set for it.
// With eight horizons the sun may be anywhere, and its horizon is taken between the two that are
// nearest to its azimuth, which rounds off what is between them. A sun that is off the arc set for
// it takes the eight; so does that of a daylight, whose azimuth no parameter knows.
#ifndef LIGHTING_HORIZON_SUN_ARC
#define LIGHTING_HORIZON_SUN_ARC
#include "maths/angle.glsl"

// How many directions the horizons were measured in.
const int ARC = 0;
const int EIGHT = 1;

const float MAX_OFF_ARC = 2e-4;  // the sine of 0.01 degrees

// How many count for a sun of a daylight, or of a parameter.
int directions_for(vec3 to_sun, float arc, int measured, bool of_daylight) {
    vec2 level = cos_sin_degrees(arc).yx;
    float off_arc = abs(to_sun.x * level.y - to_sun.y * level.x);
    return of_daylight || off_arc > MAX_OFF_ARC ? EIGHT : measured;
}

// The two measured horizons that the sun is between, and how much each counts. The first is one
// of the four that are upright: 0 the arc's, 1 its opposite, 2 and 3 square to them; the second
// is one of the four between these, in the same order.
struct Between {
    ivec2 which;
    vec2 weights;
};

// Which of four one is, as they lie around: the opposite of the first comes third.
int among_four(int around) {
    return ((around & 1) << 1) | (around >> 1);
}

// For a sun on its arc it is the first or the one opposite; else the two that are nearest of
// eight, 45 degrees apart counterclockwise from the arc's.
Between between_horizons(vec3 to_sun, float arc, int measured) {
    if (measured == ARC) {
        bool far = dot(to_sun.xy, cos_sin_degrees(arc).yx) < 0.0;
        return Between(ivec2(far ? 1 : 0, 0), vec2(1.0, 0.0));
    }
    // Straight up, no azimuth is the sun's.
    vec2 level = dot(to_sun.xy, to_sun.xy) < 1e-12 ? vec2(0.0, 1.0) : to_sun.xy;
    float turn = (arc - degrees(atan(level.x, level.y))) / 45.0;
    float before = floor(turn), beyond = turn - before;
    int sector = int(before) & 7;
    bool from_upright = (sector & 1) == 0;
    return Between(
        ivec2(among_four(((sector + 1) & 7) >> 1), among_four(sector >> 1)),
        from_upright ? vec2(1.0 - beyond, beyond) : vec2(beyond, 1.0 - beyond)
    );
}

// The elevation of a unit vector.
float elevation_of(vec3 to_sun) {
    return degrees(atan(to_sun.z, length(to_sun.xy)));
}

// An angle in diameters of the sun. A sun without width is seen whole or not at all.
float in_diameters(float angle, float diameter) {
    return angle / max(diameter, 1e-6);
}

// Eq. 3.8: how much of the sun's diameter is over the horizon, from the elevation of its upper
// edge and the horizon's, both in diameters. The part of the disc's area differs from this by up
// to 0.058.
float disc_seen(float edge, float horizon) {
    return clamp(edge - horizon, 0.0, 1.0);
}
#endif
