// water/rough_mirror.glsl -- a rough water surface as a mirror: what is seen in it, and the sun.
//
//   gives    MIRRORS, Mirrors, mirrors_of, sun_glint, SUN_SPREAD
//   needs    water/fresnel.glsl: pure functions, no uniforms, no textures
//   units    unit vectors away from the surface, z up; slopes in metres over metres; variance of
//            slopes, both axes together; glint in times the brightness of white paper that faces
//            the sun
//   source   slopes have a normal distribution: Cox and Munk 1954, J. Opt. Soc. Am. 44(11);
//            reflection by those slopes that the eye sees: Ross, Dion and Potvin 2005, "Detailed
//            analytical approach to the Gaussian surface bidirectional reflectance distribution
//            function", J. Opt. Soc. Am. A 22(11); as a sum of few by the quadrature of Gauss and
//            Hermite: made here
//   tested   tests/glsl/test_water_surface.py, against a sum over slopes in float64: what is
//            mirrored, and all of the glint
//
// The eye sees a slope s by how much it faces the eye, m(s) = max(0, v.z - s . v.xy). A flat view
// sees the near sides of waves, and the mirrored rays rise. Along the line of sight MIRRORS slopes
// stand for all:  mirrored = sum w m F L / sum w m,  and the visible area is  A = sum w m.
// Of F that is off by no more than 0.03, and seen flatter than 10 degrees in a gale by 0.06.
#ifndef WATER_ROUGH_MIRROR
#define WATER_ROUGH_MIRROR
#include "water/fresnel.glsl"

const int MIRRORS = 3;
const vec3 NODES = vec3(-1.7320508, 0.0, 1.7320508);
const vec3 NODE_WEIGHTS = vec3(0.16666667, 0.66666667, 0.16666667);

// The sun is no point: what a disc of 0.265 degrees adds to the variance of slopes.
const float SUN_SPREAD = 2.67e-6;

struct Mirrors {
    vec3 to[MIRRORS];      // where what is mirrored comes from
    float share[MIRRORS];  // how much of it; the sum is what the surface mirrors in all
    float mirrored;
    float area;            // that the eye sees, of one unit of level water
};

// To an eye at `to_eye`, of a surface with a slope and what more there is of variance.
Mirrors mirrors_of(vec3 to_eye, vec2 slope, float variance) {
    vec2 level = to_eye.xy / max(length(to_eye.xy), 1e-6);
    float spread = sqrt(0.5 * variance);
    Mirrors found;
    float area = 0.0;
    for (int k = 0; k < MIRRORS; k++) {
        vec2 here = slope + level * (spread * NODES[k]);
        vec3 normal = normalize(vec3(-here, 1.0));
        // Waves that lie behind others are seen by none: a little is left, so that some is.
        float facing = max(dot(to_eye, normal), 1e-3);
        float weight = NODE_WEIGHTS[k] * facing / normal.z;
        vec3 reflected = reflect(-to_eye, normal);
        // What goes on down meets water again, and leaves that upwards.
        found.to[k] = normalize(vec3(reflected.xy, max(abs(reflected.z), 1e-3)));
        found.share[k] = weight * fresnel_of_water(facing);
        area += weight;
    }
    found.mirrored = 0.0;
    found.area = area;
    for (int k = 0; k < MIRRORS; k++) {
        found.share[k] /= area;
        found.mirrored += found.share[k];
    }
    return found;
}

// The sun itself, mirrored by slopes that happen to be right; `area` as of mirrors_of.
float sun_glint(vec3 to_eye, vec3 to_sun, vec2 slope, float variance, float area) {
    vec3 between = to_eye + to_sun;
    if (to_sun.z <= 0.0 || between.z <= 1e-4) return 0.0;
    between = normalize(between);
    vec2 offset = between.xy / between.z + slope;
    float spread = variance + SUN_SPREAD;
    float likely = exp(-min(dot(offset, offset) / spread, 80.0)) / spread;
    float up = between.z * between.z;
    return fresnel_of_water(dot(to_eye, between)) * likely / (4.0 * up * up * area);
}
#endif
