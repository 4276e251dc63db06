// view/ground_texel.glsl -- what of the terrain a pixel shows, in one texel.
//
//   gives    ray_through, Ground, ground_texel, ground_of_texel, texture_on_ground,
//            draped_on_ground; all but the first in a draw's fragment stage only
//   needs    maths/drape.glsl, view/surface.glsl; eye
//   units    metres
//   source   none: packing made here
//   tested   tests/glsl/test_view_ground.py, by what comes back
//
// In the first number the inverse of its depth, along the view and not along the pixel's ray: 0
// where there is nothing. The ray says which place that is. In the second how far the next pixel
// lies on the terrain, east and north, as two floats of 16 bits, or below 0 the mark of a cut wall
// or of what is no number, neither of which has a texture. The next pixel is that to the right or
// above, whichever lies further: without a GPU that alone says which level of a texture is read,
// where its texels are as wide as high. The 7 bits move a level by 1/256 at most.
//
// Two numbers, as each more that a mesh of small triangles writes costs a tenth of its draw.
#ifndef VIEW_GROUND_TEXEL
#define VIEW_GROUND_TEXEL

// From the eye to what is 1 m deep in the view, at a place of the picture: 0..1 from below on the
// left. The rows of the matrix that turn and stretch say so without the eye, whose large numbers
// the inverse would subtract again. Linear over the picture.
vec3 ray_through(mat4 clip_from_world, vec2 place) {
    mat4 rows = transpose(clip_from_world);
    vec3 depth = rows[3].xyz;
    vec2 clip = 2.0 * place - 1.0;
    vec3 ray = cross(rows[0].xyz - clip.x * depth, rows[1].xyz - clip.y * depth);
    return ray / dot(depth, ray);
}

#ifdef FRAGMENT_STAGE
#include "maths/drape.glsl"
#include "view/surface.glsl"

struct Ground {
    vec2 place;  // east and north  [m]
    float eye_distance;  // [m]
    vec2 change;  // east and north, to the next pixel, without sign  [m]
    float mark;  // as place_of_vertex gives it
};

const float IS_BROKEN = -1000.0;

// Halves to the nearest of 16 bits: the upper ones of a float.
float packed_pair(vec2 pair) {
    uvec2 bits = floatBitsToUint(pair) + 0x8000u;
    return uintBitsToFloat((bits.y & 0xffff0000u) | bits.x >> 16);
}

vec2 unpacked_pair(float number) {
    uint bits = floatBitsToUint(number);
    return uintBitsToFloat(uvec2(bits << 16, bits & 0xffff0000u));
}

vec4 ground_texel(vec2 place, float mark) {
    vec2 right = dFdx(place), above = dFdy(place);
    vec2 change = abs(dot(right, right) > dot(above, above) ? right : above);
    float last = mark > 0.0 ? -clamp(mark, 1e-6, 1.0) : mark < BROKEN ? IS_BROKEN
                 : packed_pair(clamp(change, 1e-20, 1e20));
    return vec4(gl_FragCoord.w, last, 0.0, 1.0);
}

// What a pixel shows whose ray is that of ray_through.
Ground ground_of_texel(vec2 texel, vec3 ray) {
    float mark = texel.y < BROKEN ? IS_BROKEN : max(-texel.y, 0.0);
    vec3 offset = ray / texel.x;
    return Ground(eye.xy + offset.xy, length(offset),
                  mark == 0.0 ? unpacked_pair(texel.y) : vec2(0.0), mark);
}

// A texture at `uv`, which moves by so much from a pixel to the next; `sharper` as SHARPER is.
vec4 texture_on_ground(sampler2D image, vec2 uv, vec2 change, float sharper) {
    return textureGrad(image, uv, change * exp2(sharper), vec2(0.0));
}

// A texture that lies over the terrain, at a share of it.
vec4 draped_on_ground(sampler2D image, vec2 share, vec2 change, float sharper) {
    vec2 texels = vec2(textureSize(image, 0));
    vec2 uv = drape_uv(share, textureSize(image, 0));
    return texture_on_ground(image, uv, change * (texels - 1.0) / texels, sharper);
}
#endif
#endif
