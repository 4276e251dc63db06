// clouds/smoothed.glsl -- the mean of four by four pixels, whose marches began at sixteen places.
//
//   gives    clouds
//   needs    nothing; clouds by clouds/seen
//   units    as of clouds/seen
//   source   the pattern's period: see clouds/seen.glsl
//   tested   tests/glsl/test_cloud_pictures.py, against the mean in float64
#pragma kernel(output = "clouds:rgba16f")

uniform sampler2D rough;  //! input

vec4 kernel(ivec2 texel) {
    ivec2 last = textureSize(rough, 0) - 1;
    vec4 total = vec4(0.0);
    for (int k = 0; k < 16; k++) {
        total += texelFetch(rough, clamp(texel + ivec2(k & 3, k >> 2) - 1, ivec2(0), last), 0);
    }
    return total / 16.0;
}
