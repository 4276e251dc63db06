// sky/drops.glsl -- light among drops of water, which scatter all of it and mostly forwards.
//
//   gives    UNSCATTERED, drops_phase, drops_phase_wide, drops_peak, Diffuse, diffuse_of_beam,
//            diffuse_between, Crossing, crossing
//   needs    nothing: pure functions, no uniforms, no textures
//   units    optical depths without unit, of what is not scattered nearly straight on (the depth
//            times 1 - UNSCATTERED), counted downwards; cosines; per unit of the beam on a surface
//            that faces it, and per steradian where it says so
//   source   Joseph, Wiscombe and Weinman 1976, "The Delta-Eddington Approximation for Radiative
//            Flux Transfer", J. Atmos. Sci. 33, eqs 5 and 10 to 13, for drops that absorb nothing;
//            g = 0.85 of drops in visible light: Hu and Stamnes 1993, "An Accurate
//            Parameterization of the Radiative Properties of Water Clouds", J. Climate 6; phases:
//            Henyey and Greenstein 1941
//   tested   tests/glsl/test_drops.py, against photons followed one by one in float64
//
// Of the light that a drop turns aside, g² is taken as not turned at all; the rest is turned by
// g / (1 + g) on the mean. Light that was turned twice or more is I0 + I1 cos(angle to straight
// down). Without absorption, with q = 3/4pi and m the sine of the sun's elevation:
//   I1 = C - q m e^(-t/m)                                                              (1)
//   I0 = D - (1 - g) C t - q m² e^(-t/m)                                               (2)
// C and D are such that nothing but the beam comes in from above, and nothing from below.
#ifndef SKY_DROPS
#define SKY_DROPS

const float DROPS_G = 0.85;
const float UNSCATTERED = DROPS_G * DROPS_G;
const float WIDE_G = DROPS_G / (1.0 + DROPS_G);
const float PEAK_G = 0.92;  // how far the peak is taken as drawn out: to a few degrees
const float BEAM_Q = 0.2387324;  // 3 / 4 pi

float henyey_greenstein(float together, float g) {
    float base = 1.0 + g * g - 2.0 * g * together;
    return 0.0795775 * (1.0 - g * g) / (base * sqrt(base));  // 1 / 4 pi
}

// Of what is turned aside, without the peak; the peak; and both, of all that is scattered. They
// take the cosine between the sun and where one looks [1/sr].
float drops_phase_wide(float together) {
    return henyey_greenstein(together, WIDE_G);
}

float drops_peak(float together) {
    return henyey_greenstein(together, PEAK_G);
}

float drops_phase(float together) {
    return mix(drops_phase_wide(together), drops_peak(together), UNSCATTERED);
}

struct Diffuse {
    float mean;  // of all directions [1/sr]
    float down;  // what more comes from straight above than from the side [1/sr]
};

// Light of a beam that was scattered twice or more, at a depth of a layer; `rise` > 0 is the sine
// of the sun's elevation.
Diffuse diffuse_of_beam(float depth, float whole, float rise) {
    float last = exp(-min(whole / rise, 80.0));
    float here = exp(-min(depth / rise, 80.0));
    float c = BEAM_Q * rise * (rise + 2.0 / 3.0 - (rise - 2.0 / 3.0) * last)
            / (4.0 / 3.0 + (1.0 - WIDE_G) * whole);
    float d = BEAM_Q * rise * (rise + 2.0 / 3.0) - 2.0 / 3.0 * c;
    return Diffuse(max(d - (1.0 - WIDE_G) * c * depth - BEAM_Q * rise * rise * here, 0.0),
                   c - BEAM_Q * rise * here);
}

// The mean of all directions at a depth where `above` comes in evenly from above, `below` from
// below: it falls evenly from one to the other.
vec3 diffuse_between(vec3 above, vec3 below, float depth, float whole) {
    return mix(above, below, (2.0 / 3.0 + (1.0 - WIDE_G) * depth)
                             / (4.0 / 3.0 + (1.0 - WIDE_G) * whole));
}

struct Crossing {
    float through;    // all that comes out below, beam and scattered, of what falls on the layer
    float reflected;  // all that comes out above
};

Crossing crossing(float whole, float rise) {
    float last = exp(-min(whole / rise, 80.0));
    float through = (rise + 2.0 / 3.0 - (rise - 2.0 / 3.0) * last)
            / (4.0 / 3.0 + (1.0 - WIDE_G) * whole);
    return Crossing(through, 1.0 - through);
}
#endif
