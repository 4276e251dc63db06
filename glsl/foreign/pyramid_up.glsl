// foreign/pyramid_up.glsl -- a level of a convolution pyramid, filled from a coarser one.
//
//   gives    frame: the level's colours, and where there are none those of the coarser level
//   needs    level: this level on its way down; coarser: the result of the level half as fine
//   units    none
//   source   Farbman, Fattal and Lischinski 2011, "Convolution pyramids", section 5 (h1, h2 and g
//            of the filters for boundary interpolation); divided by alpha, as glslViewer does
//   tested   tests/dialects/test_viewer_passes.py, against NumPy
#pragma kernel(output = "frame:rgba32f")

uniform sampler2D level;    //! input
uniform sampler2D coarser;  //! input

const float H1[3] = float[](1.0334, 0.6836, 0.1507);
const float H2 = 0.0270;
const float G[2] = float[](0.7753, 0.0312);

vec4 kernel(ivec2 texel) {
    vec4 sum = vec4(0.0);
    for (int y = -1; y <= 1; ++y) {
        for (int x = -1; x <= 1; ++x) {
            ivec2 place = clamp(texel + ivec2(x, y), ivec2(0), textureSize(level, 0) - 1);
            sum += texelFetch(level, place, 0) * G[abs(x)] * G[abs(y)];
        }
    }
    ivec2 last = textureSize(coarser, 0) - 1;
    for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x) {
            ivec2 place = texel / 2 + ivec2(x, y);
            if (any(lessThan(place, ivec2(0))) || any(greaterThan(place, last))) continue;
            sum += texelFetch(coarser, place, 0) * H2 * H1[abs(x)] * H1[abs(y)];
        }
    }
    return sum.a == 0.0 ? sum : vec4(sum.rgb / sum.a, 1.0);
}
