// texturing/splat_weights.glsl -- weights of four layers that sum to 1, and their alphas.
//
//   gives    weights_of_covers, weights_of_mask, weights_in_bytes, alpha_of_layer,
//            weights_by_heights
//   needs    nothing: pure functions, no uniforms, no textures
//   units    weights, covers and alphas 0..1; heights of materials in any one unit
//   source   Belaiche 2010, sections 2.5 and 2.6, whose formula is
//            result = alpha texture + (1 - alpha) previous;                             (1)
//            the alphas of given weights and the mixture by heights: derived here
//   tested   tests/glsl/test_splat_weights.py, against (1) done step by step in float64
//
// An alpha draws its layer over those before it.
#ifndef TEXTURING_SPLAT_WEIGHTS
#define TEXTURING_SPLAT_WEIGHTS

// The first layer lies everywhere; each cover hides what lies below it, by (1).
vec4 weights_of_covers(vec3 covers) {
    vec3 clamped = clamp(covers, 0.0, 1.0);
    return vec4(1.0, clamped);  // each layer as if it were alone
}

// A mask as an image holds it, its four numbers in any proportion. Nothing at all is the first
// layer.
vec4 weights_of_mask(vec4 mask) {
    vec4 clamped = max(mask, 0.0);
    float total = clamped.x + clamped.y + clamped.z + clamped.w;
    return total > 0.0 ? clamped / total : vec4(1.0, 0.0, 0.0, 0.0);
}

// Weights in whole 255ths that sum to 1 again: rounding each by itself would leave up to two
// 255ths over, which the largest takes. It is at least a quarter, so it stays above 0.
vec4 weights_in_bytes(vec4 weights) {
    vec4 whole = floor(weights * 255.0 + 0.5);
    float over = 255.0 - (whole.x + whole.y + whole.z + whole.w);
    float maximum = max(max(whole.x, whole.y), max(whole.z, whole.w));
    if (whole.x == maximum) whole.x += over;
    else if (whole.y == maximum) whole.y += over;
    else if (whole.z == maximum) whole.z += over;
    else whole.w += over;
    return whole / 255.0;
}

// The alpha with which (1) must lay layer k, 0 to 3, over those before it: its share of what
// has been laid so far. Later layers then hide as much of all of them alike.
float alpha_of_layer(vec4 weights, int layer) {
    float own = layer == 0 ? weights.x : layer == 1 ? weights.y : layer == 2 ? weights.z
            : weights.w;
    float below = layer > 0 ? weights.x : 0.0;
    below += layer > 1 ? weights.y : 0.0;
    below += layer > 2 ? weights.z : 0.0;
    // Where nothing is laid yet, whatever comes is all there is.
    return below > 0.0 ? own / (below + own) : 1.0;
}

// Where materials meet, what is higher there comes through: grains of snow lie in the
// rock's cracks first. The odds of any two are multiplied by exp(contrast (difference of
// heights)), so a material alone stays alone, one that is absent stays absent, and all of
// it is smooth.
vec4 weights_by_heights(vec4 weights, vec4 heights, float contrast) {
    float top = max(max(heights.x, heights.y), max(heights.z, heights.w));
    vec4 raised = weights * exp(max(contrast * (heights - top), -60.0));
    return raised / (raised.x + raised.y + raised.z + raised.w);
}
#endif
