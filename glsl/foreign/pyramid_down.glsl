// foreign/pyramid_down.glsl -- a level of a convolution pyramid, of one twice as fine.
//
//   gives    frame: mean of the colours there are; alpha 1, or 0 where there are none near
//   needs    finer: colours times alpha, and alpha
//   units    none
//   source   Farbman, Fattal and Lischinski 2011, "Convolution pyramids", section 5 (h1 of the
//            filters for boundary interpolation); divided by alpha, as glslViewer does
//   tested   tests/dialects/test_viewer_passes.py, against NumPy
#pragma kernel(output = "frame:rgba32f")

uniform sampler2D finer;  //! input

const float H1[3] = float[](1.0334, 0.6836, 0.1507);

vec4 kernel(ivec2 texel) {
    vec4 sum = vec4(0.0);
    ivec2 last = textureSize(finer, 0) - 1;
    for (int y = -2; y <= 2; ++y) {
        for (int x = -2; x <= 2; ++x) {
            ivec2 place = texel * 2 + 1 + ivec2(x, y);
            if (any(lessThan(place, ivec2(0))) || any(greaterThan(place, last))) continue;
            sum += texelFetch(finer, place, 0) * H1[abs(x)] * H1[abs(y)];
        }
    }
    return sum.a == 0.0 ? sum : vec4(sum.rgb / sum.a, 1.0);
}
