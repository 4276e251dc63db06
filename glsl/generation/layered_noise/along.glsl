// generation/layered_noise/along.glsl -- the sum of the layers, from the polynomial of its band.
//
//   gives    height, for any terrain; not normalised
//   needs    nothing
//   units    heights without unit, 0..1
//   source   the sum of generation/layered_noise/sum.glsl
//   tested   tests/glsl/test_layered_noise.py, as part of the fast variant
#pragma kernel(output = "height:r32f")

uniform sampler2D rows;   //! input
uniform sampler2D bands;  //! input
uniform int overflow = 0; //! menu("divide", "clamp", "wrap") As in the technique

// anchor: kernel
float kernel(ivec2 texel) {
    // anchor: polynomial
    vec2 row = texelFetch(rows, ivec2(texel.y, 0), 0).rg;
    vec4 powers = texelFetch(bands, ivec2(texel.x, int(row.x)), 0);
    float v = row.y;
    float total = powers.x + v * (powers.y + v * (powers.z + v * powers.w));
    // end: polynomial
    if (overflow < 2) return clamp(total, 0.0, 1.0);
    return total > 1.0 ? total - (ceil(total) - 1.0) : total;
}
// end: kernel
