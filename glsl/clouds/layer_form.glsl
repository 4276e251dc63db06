// clouds/layer_form.glsl -- how tall and how dense fair-weather clouds are.
//
//   gives    CLOUD_TALL, CLOUD_MIDDLE, CLOUD_EXTINCTION, CLOUD_DEPTH, CLOUD_STEEP, CLOUD_FOOT,
//            thickness_of, depth_straight_up
//   needs    sky/drops.glsl
//   units    metres; extinction per metre; optical depths as in sky/drops.glsl
//   source   extinction of drops 3 W / (2 rho r): Stephens 1978, "Radiation Profiles in Extended
//            Water Clouds II", J. Atmos. Sci. 35; W = 0.26 g/m³ of water in drops of r = 5.8
//            micrometres, as of the continental cumulus of Hess, Koepke and Schult 1998, "Optical
//            Properties of Aerosols and Clouds", Bull. Amer. Meteor. Soc. 79
//   tested   tests/glsl/test_clouds.py: the mean of their shadows is the cover's
#ifndef CLOUDS_LAYER_FORM
#define CLOUDS_LAYER_FORM
#include "sky/drops.glsl"

const float CLOUD_TALL = 900.0;           // the thickest
const float CLOUD_MIDDLE = 270.0;         // over the base: where half of the cloud is below
const float CLOUD_EXTINCTION = 0.067;
const float CLOUD_STEEP = 16.0;           // full density 56 m under the surface, and
const float CLOUD_FOOT = 0.035;           // so far over the base, in the tallest
const float CLOUD_DEPTH = (1.0 - UNSCATTERED) * CLOUD_EXTINCTION * CLOUD_TALL;

// How thick the cloud is, as a share of the thickest, of a shape by clouds/field/shape: where that
// is over the edge, a round top.
float thickness_of(float shape, float edge) {
    float over = clamp((shape - edge) / (1.0 - min(edge, 0.99)), 0.0, 1.0);
    return 1.0 - exp(-2.0 * over);
}

// The optical depth from base to top of a cloud of a thickness: what is missing of full density at
// both ends is half of each, and in a thin one nearly all.
float depth_straight_up(float thick) {
    const float MISSING = 0.5 * CLOUD_FOOT + 0.5 / CLOUD_STEEP;
    const float SOFT = 0.015;
    float over = SOFT * log((1.0 + exp((thick - MISSING) / SOFT)) / (1.0 + exp(-MISSING / SOFT)));
    return CLOUD_DEPTH * over;
}
#endif
