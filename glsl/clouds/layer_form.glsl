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
//   tested   tests/glsl/test_clouds.py: the mean of their shadows is the cover's;
//            depths, against the sum of densities in float64
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

// The density over the base, 3 x² - 2 x³ with x = up / CLOUD_FOOT and then 1, summed over the
// height, and that sum summed again.
float twice_summed(float up) {
    float x = max(up, 0.0) / CLOUD_FOOT;
    float part = x < 1.0 ? x * x * x * x * (0.25 - 0.1 * x) : 0.15 + 0.5 * x * (x - 1.0);
    return CLOUD_FOOT * CLOUD_FOOT * part;
}

// The optical depth from base to top of a cloud of a thickness. Below the top density is the
// lesser of 1 and CLOUD_STEEP (thick - up), the difference of two ramps; the integral of a ramp
// times the density over the base is that summed twice.
float depth_straight_up(float thick) {
    float under_ramps = twice_summed(thick) - twice_summed(thick - 1.0 / CLOUD_STEEP);
    return CLOUD_DEPTH * CLOUD_STEEP * under_ramps;
}
#endif
