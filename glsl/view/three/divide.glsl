// view/three/divide.glsl -- three pictures in one, divided by two lines.
//
//   gives    frame, display-encoded
//   needs    three frames of this size
//   units    display-encoded levels, 0..1; the lines' places as shares of the width
//   source   none: a picture of pictures
//   tested   tests/glsl/test_three_view.py, against the pictures themselves
#pragma kernel(output = "frame:rgba8")

uniform sampler2D left;        //! input
uniform sampler2D middle;      //! input
uniform sampler2D right;       //! input
uniform float first = 0.3333;  //! divider step(0.005) group("Compare")
                               //! Where the first line is, from the left
uniform float second = 0.6667; //! divider step(0.005) group("Compare")
                               //! Where the second line is; left of the first, nothing is
                               //! between them

vec4 kernel(ivec2 texel) {
    float place = float(texel.x) + 0.5;
    vec2 lines = vec2(first, max(first, second)) * float(size.x);
    vec2 gap = abs(place - lines);
    // A line at an end of the picture is not drawn.
    bvec2 drawn = bvec2(lines.x > 0.0 && lines.x < float(size.x),
                        lines.y > 0.0 && lines.y < float(size.x));
    float near = min(drawn.x ? gap.x : 2.0, drawn.y ? gap.y : 2.0);
    if (near < 2.0) return vec4(vec3(near < 1.0 ? 1.0 : 0.0), 1.0);
    if (place < lines.x) return vec4(texelFetch(left, texel, 0).rgb, 1.0);
    if (place < lines.y) return vec4(texelFetch(middle, texel, 0).rgb, 1.0);
    return vec4(texelFetch(right, texel, 0).rgb, 1.0);
}
