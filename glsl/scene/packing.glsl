// scene/packing.glsl -- a direction and one of 64 kinds in a number from 4 on, and back.
//
//   gives    packed_object, kind_of, normal_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    unit vectors; kinds 0 to 63
//   source   octahedral normals of 8 + 8 bits: Cigolle, Donow, Evangelakos, Mara, McGuire and
//            Meyer 2014, "A Survey of Efficient Representations for Independent Unit Vectors",
//            Journal of Computer Graphics Techniques 3(2)
//   tested   tests/glsl/test_packing.py: the way there and back
//
// A pass that says which point each pixel sees has one number left: 0 sky, 1 the terrain's top, 2
// its cut, 3 water. What stands on the terrain takes the 2^22 whole numbers from 4 on, which
// floats of 32 bits hold exactly.
#ifndef SCENE_PACKING
#define SCENE_PACKING

const float FIRST_OBJECT = 4.0;

vec2 signs_of(vec2 v) { return vec2(v.x < 0.0 ? -1.0 : 1.0, v.y < 0.0 ? -1.0 : 1.0); }

// The sphere's lower half is folded over the corners of the square that the upper half fills.
float packed_object(vec3 normal, int kind) {
    vec3 n = normal / (abs(normal.x) + abs(normal.y) + abs(normal.z));
    vec2 square = n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * signs_of(n.xy);
    uvec2 bits = uvec2(clamp(0.5 * square + 0.5, 0.0, 1.0) * 255.0 + 0.5);
    return FIRST_OBJECT + float((bits.x * 256u + bits.y) * 64u + uint(clamp(kind, 0, 63)));
}

int kind_of(float number) { return int(uint(number - FIRST_OBJECT + 0.5) & 63u); }

vec3 normal_of(float number) {
    uint bits = uint(number - FIRST_OBJECT + 0.5) / 64u;
    vec2 square = vec2(bits / 256u, bits & 255u) / 255.0 * 2.0 - 1.0;
    vec3 n = vec3(square, 1.0 - abs(square.x) - abs(square.y));
    if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * signs_of(n.xy);
    return normalize(n);
}
#endif
