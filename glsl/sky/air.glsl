// sky/air.glsl -- what the air is made of, and how it scatters light.
//
//   gives    Air, air_of, densities, extinction, SUN_RADIUS, phase_molecules, phase_aerosol
//   needs    nothing: pure functions, no uniforms, no textures
//   units    per kilometre at sea level (ozone: where it is densest), for red, green and blue;
//            kilometres; phases per steradian
//   source   Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight", appendix
//            on the sun's light (optical depths of molecules, 0.008735 λ^-4.08, and of aerosol,
//            (0.04608 T - 0.04586) λ^-1.3; ozone 0.35 cm and its coefficients); layers of 8 and
//            1.2 km, ozone's tent and the aerosol's albedo of 0.9 from Bruneton 2017, "A
//            Qualitative and Quantitative Evaluation of 8 Clear Sky Models"; phase_aerosol:
//            Cornette and Shanks 1992, "Physically reasonable analytic expression for the
//            single-scattering phase function", with g = 0.8
//   tested   tests/glsl/test_air.py, against the whole spectrum in float64
//
// It is made of molecules, aerosol and ozone.
//
// Three wavelengths represent the spectrum, and white is the sun outside the air, as with a
// camera balanced for daylight. They, and ozone's coefficients, were fitted here: the sun's light
// through 1 to 20 air masses, turbidity 2 to 6, has the linear sRGB colour that 81 wavelengths
// and the eye's response give it, to 0.035 of its strongest channel.
#ifndef SKY_AIR
#define SKY_AIR

struct Air {
    vec3 molecules;
    vec3 aerosol;
    vec3 ozone;
};

const vec3 WAVELENGTHS = vec3(0.627, 0.539, 0.440);  // [µm]
const vec3 OZONE_ABSORBS = vec3(0.095, 0.067, 0.0);  // [1/cm]
const float AEROSOL_ALBEDO = 0.9;                    // what it scatters of what it takes away
const float FORWARD = 0.8;                           // how far forward it scatters, 0 to 1

const float SUN_RADIUS = 0.265;  // [degrees]

// Turbidity: 2 very clear, 3 clear, 6 hazy.
Air air_of(float turbidity) {
    vec3 molecules = 0.008735 * pow(WAVELENGTHS, vec3(-4.08)) / 8.0;
    vec3 aerosol = max(0.04608 * turbidity - 0.04586, 0.0) * pow(WAVELENGTHS, vec3(-1.3)) / 1.2;
    return Air(molecules, aerosol, 0.35 * OZONE_ABSORBS / 15.0);
}

// How dense molecules, aerosol and ozone are at a height, 1 where their coefficients hold. Above
// 60 km there is as good as no aerosol; were there less and less, its amounts would become so
// small that some processors keep them and some do not.
vec3 densities(float height) {
    return vec3(exp(-height / 8.0), exp(-min(height, 60.0) / 1.2),
                max(0.0, 1.0 - abs(height - 25.0) / 15.0));
}

// What is taken from light by amounts of the three: densities per kilometre, or times kilometres.
vec3 extinction(Air air, vec3 amounts) {
    return air.molecules * amounts.x + air.aerosol * amounts.y + air.ozone * amounts.z;
}

// Rayleigh's, of the cosine between the sun and where one looks.
float phase_molecules(float together) {
    return 0.0596831 * (1.0 + together * together);  // 3 / 16 pi
}

float phase_aerosol(float together) {
    const float g = FORWARD;
    float base = 1.0 + g * g - 2.0 * g * together;
    // 3 / 8 pi
    return 0.1193662 * (1.0 - g * g) / (2.0 + g * g) * (1.0 + together * together)
            / (base * sqrt(base));
}
#endif
