// scene/mist.glsl -- mist that lies low: how much of it is between two heights, and above one.
//
//   gives    mean_mist, mist_above
//   needs    nothing: pure functions, no uniforms, no textures
//   units    heights over the level at which it is thickest, and `top`, in one unit of length
//   source   an exponential layer; the integral derived here
//   tested   tests/glsl/test_scene_air.py, against numerical integration in float64
//
// Its density at height z is e^(-z / top), and 1 below the level. Between heights a < b, both
// over the level, the mean density is e^(-a/top) (1 - e^-u) / u with u = (b - a) / top: nothing
// there overflows or cancels.
#ifndef SCENE_MIST
#define SCENE_MIST

// (1 - e^-u) / u, whose quotient cancels where u is small: the series is off by less than u^3/24.
float mean_decay(float u) {
    return u < 1e-2 ? 1.0 - u * (0.5 - u / 6.0) : (1.0 - exp(-u)) / u;
}

// The mean density over a straight path from one height to another, in any order.
float mean_mist(float from, float to, float top) {
    float low = min(from, to);
    float high = max(from, to);
    float start = max(low, 0.0);
    float above = max(high, 0.0) - start;
    float mean = exp(-start / top) * mean_decay(above / top);
    if (low >= 0.0 || high <= low) return mean;
    return mix(1.0, mean, above / (high - low));
}

// The density above a height, summed straight up.
float mist_above(float height, float top) {
    return top * exp(-max(height, 0.0) / top) + max(-height, 0.0);
}
#endif
