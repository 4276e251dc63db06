// view/compare/divide.glsl -- two pictures in one: one on each side of a line, or how they differ.
//
//   gives    frame, display-encoded
//   needs    two frames of this size
//   units    display-encoded levels, 0..1; the line's place as a share of the width
//   source   none: a picture of two pictures
//   tested   tests/glsl/test_compare_view.py, against the pictures themselves
#pragma kernel(output = "frame:rgba8")

uniform sampler2D left;        //! input
uniform sampler2D right;       //! input
uniform int mode = 0;          //! menu("side by side", "difference") group("Compare")
                               //! label("Compare")
                               //! One on each side of a line, or how far they are apart
uniform float divider = 0.5;   //! divider step(0.005) group("Compare")
                               //! Where the line is, from the left
uniform float amplified = 4.0; //! log_slider(1, 64) group("Compare")
                               //! The difference is multiplied by it; grey where there is none

vec4 kernel(ivec2 texel) {
    vec3 one = texelFetch(left, texel, 0).rgb;
    vec3 other = texelFetch(right, texel, 0).rgb;
    if (mode == 1) return vec4(0.5 + amplified * 0.5 * (other - one), 1.0);
    float place = divider * float(size.x);
    float gap = abs(float(texel.x) + 0.5 - place);
    // A light line with a dark rim is seen on any picture.
    if (divider > 0.0 && divider < 1.0 && gap < 2.0) {
        return vec4(vec3(gap < 1.0 ? 1.0 : 0.0), 1.0);
    }
    return vec4(float(texel.x) + 0.5 < place ? one : other, 1.0);
}
