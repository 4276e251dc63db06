// lighting/horizons/open_sky.glsl -- what a sector of open sky over a horizon gives to a slope.
//
//   gives    above_horizon, horizon_over_slope, sector_shape, sky_of_sector, thrown_back
//   needs    nothing: pure functions, no uniforms, no textures
//   units    tangents of elevations and slopes: rises over runs; shares of what an open, even sky
//            gives
//   source   Belaiche 2010, section 3.4, eqs 3.11 to 3.15, after Stewart and Langer 1997, "Towards
//            Accurate Recovery of Shape from Shading under Diffuse Lighting"
//   tested   tests/glsl/test_sky.py, against quadrature
//
// K(p) is 1/2pi of N · the sum over the sectors of
//   ((phi - sin 2phi / 2) dsin, (phi - sin 2phi / 2) dcos, width sin² phi)
// with phi the horizon's angle from the vertical. With w the width of each of n sectors, and u the
// level unit vector to a sector's middle, dsin and dcos are 2 sin(w/2) u, and
//   K = 1/n of the sum of  N_z sin² phi + (N · u) (phi - sin 2phi / 2) sin(w/2) / (w/2).
// The thesis begins the sectors at the directions in which the horizon is measured; here they are
// centred on them, for else mirrored terrain would not have mirrored light.
#ifndef LIGHTING_HORIZONS_OPEN_SKY
#define LIGHTING_HORIZONS_OPEN_SKY

// (phi - sin 2phi / 2, sin² phi) of a horizon by its tangent, which is 0 or more.
vec2 above_horizon(float tangent) {
    float upright = 1.0 / (1.0 + tangent * tangent);
    return vec2(max(1.57079633 - atan(tangent) - tangent * upright, 0.0), upright);
}

// A horizon clamped to the hemispheres over the slope and over level ground: what the slope itself
// hides is not lit, and below the level there is no sky.
float horizon_over_slope(float tangent, vec2 slope, vec2 towards) {
    return max(max(tangent, dot(slope, towards)), 0.0);
}

// sin(w/2) / (w/2) for one of n sectors.
float sector_shape(int sectors) {
    float half_width = 3.14159265 / float(sectors);
    return sin(half_width) / half_width;
}

// How much more light there is than the sky's alone, where ground of that colour throws it back
// once, by K of the whole sky.
vec3 thrown_back(vec3 ground, float k) {
    return 1.0 + ground * (1.0 - k);
}

// What the sector towards u adds to n K, times the length of (-slope, 1).
float sky_of_sector(float tangent, vec2 slope, vec2 towards, float shape) {
    vec2 open = above_horizon(horizon_over_slope(tangent, slope, towards));
    return open.y - dot(slope, towards) * shape * open.x;
}
#endif
