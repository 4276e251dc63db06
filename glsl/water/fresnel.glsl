// water/fresnel.glsl -- how much light a water surface mirrors, and how steeply the rest goes on.
//
//   gives    WATER_INDEX, fresnel_of_water, refracted_cosine, DIFFUSE_MIRRORED
//   needs    nothing: pure functions, no uniforms, no textures
//   units    cosines to the surface's normal, on the side of the air; shares 0..1
//   source   Fresnel's equations for unpolarised light, as in Cook and Torrance 1982, "A
//            Reflectance Model for Computer Graphics", ACM Transactions on Graphics 1(1)
//   tested   tests/glsl/test_water_surface.py, against both polarisations by angles in float64
//
// The exact formula costs one root. Schlick's, for water, is off by up to 0.06, at 84°.
#ifndef WATER_FRESNEL
#define WATER_FRESNEL

const float WATER_INDEX = 1.333;

// The same for light that comes evenly from all of the sky, as an integral of the formula.
const float DIFFUSE_MIRRORED = 0.0664;

float fresnel_of_water(float cosine) {
    float c = clamp(cosine, 0.0, 1.0);
    float g = sqrt(WATER_INDEX * WATER_INDEX - 1.0 + c * c);
    float across = (g - c) / (g + c);
    float along = (c * (g + c) - 1.0) / (c * (g - c) + 1.0);
    return 0.5 * across * across * (1.0 + along * along);
}

// Snell's law: the cosine below the surface.
float refracted_cosine(float cosine) {
    return sqrt(1.0 - (1.0 - cosine * cosine) / (WATER_INDEX * WATER_INDEX));
}
#endif
