// colour/ramp.glsl -- a number 0..1 as a colour that people with colour-blindness can order, too.
//
//   gives    ramp_blue_yellow, ramp_viridis, ramp_cividis, ramp_cool_warm; ramp_colour, one of
//            them by number
//   needs    nothing: pure functions, no uniforms, no textures
//   units    0..1 in, sRGB-encoded colour out
//   source   blue_yellow made here: five stops from dark blue to pale yellow whose lightness rises
//            evenly, and whose order survives the loss of red or of green;
//            viridis: S. van der Walt and N. Smith 2015, CC0, 33 colours along its table of 256;
//            cividis: J. Nuñez, C. Anderton and R. Renslow 2018, "Optimizing colormaps with
//            consideration for color vision deficiency" (PLOS ONE 13(7), CC BY 4.0), likewise;
//            cool_warm: worked out by K. Moreland 2009, "Diverging Color Maps for Scientific
//            Visualization", from his two ends, through grey in the middle
//   tested   tests/glsl/test_colour.py: lightness rises at every step, or to the middle and falls;
//            the published colours at the ends and between
#ifndef COLOUR_RAMP
#define COLOUR_RAMP

vec3 ramp_blue_yellow(float share) {
    const vec3 s0 = vec3(0.05, 0.07, 0.29);
    const vec3 s1 = vec3(0.13, 0.28, 0.49);
    const vec3 s2 = vec3(0.35, 0.47, 0.52);
    const vec3 s3 = vec3(0.72, 0.67, 0.42);
    const vec3 s4 = vec3(0.99, 0.93, 0.62);
    float t = clamp(share, 0.0, 1.0) * 4.0;
    if (t < 1.0) return mix(s0, s1, t);
    if (t < 2.0) return mix(s1, s2, t - 1.0);
    if (t < 3.0) return mix(s2, s3, t - 2.0);
    return mix(s3, s4, t - 3.0);
}

const vec3 RAMP_VIRIDIS[33] = vec3[33](
    vec3(0.267, 0.005, 0.329), vec3(0.277, 0.050, 0.376), vec3(0.282, 0.095, 0.417),
    vec3(0.283, 0.135, 0.453), vec3(0.279, 0.175, 0.483), vec3(0.271, 0.213, 0.507),
    vec3(0.259, 0.251, 0.524), vec3(0.245, 0.287, 0.537), vec3(0.230, 0.321, 0.545),
    vec3(0.215, 0.354, 0.551), vec3(0.200, 0.386, 0.555), vec3(0.186, 0.417, 0.557),
    vec3(0.173, 0.447, 0.558), vec3(0.161, 0.477, 0.558), vec3(0.150, 0.506, 0.557),
    vec3(0.138, 0.536, 0.555), vec3(0.128, 0.565, 0.551), vec3(0.121, 0.594, 0.544),
    vec3(0.120, 0.624, 0.534), vec3(0.131, 0.653, 0.521), vec3(0.155, 0.682, 0.503),
    vec3(0.193, 0.710, 0.481), vec3(0.241, 0.737, 0.455), vec3(0.299, 0.762, 0.423),
    vec3(0.363, 0.787, 0.387), vec3(0.433, 0.809, 0.345), vec3(0.508, 0.829, 0.299),
    vec3(0.587, 0.847, 0.249), vec3(0.669, 0.862, 0.195), vec3(0.753, 0.875, 0.143),
    vec3(0.836, 0.886, 0.102), vec3(0.917, 0.896, 0.101), vec3(0.993, 0.906, 0.144)
);

const vec3 RAMP_CIVIDIS[33] = vec3[33](
    vec3(0.000, 0.135, 0.305), vec3(0.000, 0.158, 0.357), vec3(0.000, 0.179, 0.414),
    vec3(0.017, 0.198, 0.441), vec3(0.102, 0.220, 0.436), vec3(0.153, 0.242, 0.430),
    vec3(0.194, 0.264, 0.426), vec3(0.230, 0.286, 0.424), vec3(0.263, 0.307, 0.423),
    vec3(0.294, 0.329, 0.424), vec3(0.323, 0.350, 0.426), vec3(0.352, 0.372, 0.430),
    vec3(0.380, 0.394, 0.435), vec3(0.407, 0.416, 0.442), vec3(0.434, 0.439, 0.451),
    vec3(0.460, 0.461, 0.461), vec3(0.487, 0.484, 0.471), vec3(0.516, 0.507, 0.473),
    vec3(0.546, 0.530, 0.472), vec3(0.576, 0.554, 0.469), vec3(0.607, 0.578, 0.464),
    vec3(0.638, 0.602, 0.457), vec3(0.669, 0.627, 0.449), vec3(0.701, 0.652, 0.438),
    vec3(0.733, 0.678, 0.425), vec3(0.766, 0.704, 0.410), vec3(0.799, 0.731, 0.392),
    vec3(0.833, 0.759, 0.371), vec3(0.867, 0.786, 0.346), vec3(0.902, 0.815, 0.317),
    vec3(0.937, 0.844, 0.281), vec3(0.973, 0.874, 0.234), vec3(0.996, 0.909, 0.218)
);

const vec3 RAMP_COOL_WARM[33] = vec3[33](
    vec3(0.230, 0.299, 0.754), vec3(0.266, 0.353, 0.802), vec3(0.304, 0.407, 0.845),
    vec3(0.343, 0.459, 0.884), vec3(0.383, 0.510, 0.918), vec3(0.425, 0.558, 0.946),
    vec3(0.467, 0.605, 0.968), vec3(0.510, 0.648, 0.985), vec3(0.553, 0.689, 0.995),
    vec3(0.596, 0.726, 1.000), vec3(0.639, 0.760, 0.998), vec3(0.681, 0.789, 0.990),
    vec3(0.722, 0.814, 0.977), vec3(0.762, 0.834, 0.957), vec3(0.799, 0.850, 0.932),
    vec3(0.833, 0.860, 0.901), vec3(0.865, 0.865, 0.865), vec3(0.898, 0.849, 0.821),
    vec3(0.924, 0.827, 0.775), vec3(0.945, 0.801, 0.727), vec3(0.959, 0.770, 0.678),
    vec3(0.968, 0.734, 0.629), vec3(0.970, 0.694, 0.580), vec3(0.967, 0.651, 0.530),
    vec3(0.958, 0.603, 0.482), vec3(0.944, 0.552, 0.434), vec3(0.924, 0.497, 0.388),
    vec3(0.899, 0.440, 0.343), vec3(0.870, 0.379, 0.300), vec3(0.835, 0.313, 0.259),
    vec3(0.796, 0.241, 0.220), vec3(0.753, 0.157, 0.184), vec3(0.706, 0.016, 0.150)
);

vec3 ramp_viridis(float share) {
    float t = clamp(share, 0.0, 1.0) * 32.0;
    int low = min(int(t), 31);
    return mix(RAMP_VIRIDIS[low], RAMP_VIRIDIS[low + 1], t - float(low));
}

vec3 ramp_cividis(float share) {
    float t = clamp(share, 0.0, 1.0) * 32.0;
    int low = min(int(t), 31);
    return mix(RAMP_CIVIDIS[low], RAMP_CIVIDIS[low + 1], t - float(low));
}

// 0.5 is the middle, from which both sides go away.
vec3 ramp_cool_warm(float share) {
    float t = clamp(share, 0.0, 1.0) * 32.0;
    int low = min(int(t), 31);
    return mix(RAMP_COOL_WARM[low], RAMP_COOL_WARM[low + 1], t - float(low));
}

// By the number that view/map's menu gives each; 0 is grey.
vec3 ramp_colour(int ramp, float share) {
    if (ramp == 1) return ramp_blue_yellow(share);
    if (ramp == 2) return ramp_viridis(share);
    if (ramp == 3) return ramp_cividis(share);
    if (ramp == 4) return ramp_cool_warm(share);
    return vec3(clamp(share, 0.0, 1.0));
}
#endif
