// generation/layered_noise/along.glsl -- the sum of the layers at each texel, from the polynomial of its band.
//
//   gives    height, for any land; not normalised
//   needs    nothing
//   units    heights without unit, 0..1
//   source   Belaiche 2010, section 1.3.9
//   tested   tests/glsl/test_layered_noise.py, against a twin in NumPy written as its loops
//
// Mended: the thesis's curve returns the second node wherever nodes are one texel apart, also
// at the first node itself (slip 4). Its bytes are floats here, so a sum wraps at 1 where
// bytes wrap after 255.
#pragma kernel(output = "height:r32f")

uniform sampler2D rows;   //! input
uniform sampler2D bands;  //! input
uniform int overflow = 0; //! menu("divide", "clamp", "wrap") A sum above 1: divided by the weights' sum, cut, or begun again at 0 (a fault, to look at)

float kernel(ivec2 texel) {
    vec2 row = texelFetch(rows, ivec2(texel.y, 0), 0).rg;
    vec4 powers = texelFetch(bands, ivec2(texel.x, int(row.x)), 0);
    float v = row.y;
    float total = powers.x + v * (powers.y + v * (powers.z + v * powers.w));
    if (overflow < 2) return clamp(total, 0.0, 1.0);
    return total > 1.0 ? total - (ceil(total) - 1.0) : total;
}
