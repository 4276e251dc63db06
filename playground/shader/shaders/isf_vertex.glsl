// Two triangles over the whole picture, of which a part may be drawn: corners alone say what lies between.
uniform vec4 $shares;
out vec2 isf_FragNormCoord;
#define vv_FragNormCoord isf_FragNormCoord
#define vv_vertShaderInit isf_vertShaderInit
#define IMG_THIS_PIXEL(k_image) texture(k_image, isf_FragNormCoord)
#define IMG_THIS_NORM_PIXEL(k_image) texture(k_image, isf_FragNormCoord)
void isf_vertShaderInit() {
    int k_of_three = gl_VertexID % 3;
    vec2 k_corner = vec2(k_of_three & 1, k_of_three >> 1);
    isf_FragNormCoord = gl_VertexID < 3 ? k_corner : 1.0 - k_corner;
    gl_Position = vec4((isf_FragNormCoord - $shares.xy) / $shares.zw * 2.0 - 1.0, 0.0, 1.0);
}
