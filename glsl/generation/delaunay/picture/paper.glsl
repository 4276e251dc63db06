// generation/delaunay/picture/paper.glsl -- what was drawn, over paper or over another picture.
//
//   gives    frame, linear colours
//   needs    nothing
//   units    colours linear; what is drawn is multiplied by its cover
//   source   Porter and Duff 1984, "Compositing Digital Images" (SIGGRAPH): over
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
#pragma kernel(output = "frame:rgba16f")

uniform sampler2D drawn;  //! input
uniform sampler2D under;  //! input("linear", "white")
uniform vec3 paper = vec3(0.93, 0.91, 0.87);  //! colour group("Colours") The paper; it colours a
    //! picture that lies under the lines

vec4 kernel(ivec2 texel) {
    vec4 over = texelFetch(drawn, texel, 0);
    vec3 below = paper * textureLod(under, (vec2(texel) + 0.5) / vec2(size), 0.0).rgb;
    return vec4(over.rgb + below * (1.0 - over.a), 1.0);
}
