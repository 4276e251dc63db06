// foreign/sky_box.glsl -- a plain sky, where nothing feeds a cube map of another tool's shader.
//
//   gives    channel_texels, colours encoded for the display; six faces above each other
//   needs    maths/cube.glsl
//   units    none; +Y up
//   source   made here
//   tested   tests/glsl/test_foreign.py: the sun, the horizon and the ground are in their places
//
// The faces are OpenGL's, +X -X +Y -Y +Z -Z from the bottom, in N x 6N texels. The ground is
// redder towards +X and greener towards +Z, so that a cube turned the wrong way shows as one. The
// sun of each number stands in another place, and the sky has another tint.
#include "maths/cube.glsl"
#pragma kernel(output = "channel_texels:rgba8")

uniform int number = 0;  //! slider(0, 99) Which sky: each has a sun and a tint of its own

vec4 kernel(ivec2 texel) {
    int face = texel.y * 6 / size.y;
    ivec2 on_face = ivec2(texel.x, texel.y - face * size.x);
    vec2 place = (vec2(on_face) + 0.5) / float(size.x) * 2.0 - 1.0;
    vec3 direction = normalize(cube_direction(face, place));
    float turn = 0.618034 * float(number);
    float azimuth = 6.2831853 * (turn + 0.1);
    vec3 towards_sun = vec3(0.8 * cos(azimuth), 0.6, 0.8 * sin(azimuth));
    vec3 tint = 0.5 + 0.5 * cos(6.2831853 * (turn + vec3(0.5, 0.75, 0.0)));
    if (direction.y < 0.0) {
        vec3 ground = vec3(0.3 + 0.2 * direction.x, 0.3 + 0.2 * direction.z, 0.2);
        return vec4(mix(ground, tint, 0.1), 1.0);
    }
    vec3 sky = mix(vec3(0.85), mix(vec3(0.2, 0.4, 0.8), tint, 0.4), sqrt(direction.y));
    float sun = smoothstep(0.98, 0.99, dot(direction, towards_sun));
    return vec4(mix(sky, vec3(1.0), sun), 1.0);
}
