out vec4 k_frag_color;
void main() {
    vec2 k_pixel = gl_FragCoord.xy + vec2($window);
    int k_face = int(k_pixel.y / k_side);
    k_pixel.y -= float(k_face) * k_side;
    vec2 k_place = k_pixel / k_side * 2.0 - 1.0;  // faces and their axes: glsl/maths/cube.glsl
    float k_way = (k_face & 1) == 0 ? 1.0 : -1.0;
    vec3 k_ray = vec3(k_way * k_place.x, -k_place.y, k_way);
    if (k_face < 2) k_ray = vec3(k_way, -k_place.y, -k_way * k_place.x);
    else if (k_face < 4) k_ray = vec3(k_place.x, k_way, k_way * k_place.y);
    k_ray = normalize(k_ray);
    vec3 k_origin = vec3(0.0);
    vec4 k_picture = vec4(0.0);
    mainCubemap(k_picture, k_pixel, k_origin, k_ray);
    k_frag_color = k_picture;
}
