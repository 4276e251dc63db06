// texturing/alpha_map/path.glsl -- where a path lies: a smooth line through four points.
//
//   gives    cover, 0..1
//   needs    maths/land.glsl, maths/segment.glsl, noise/periodic.glsl
//   units    points as shares of the terrain, east and north; widths in metres
//   source   Belaiche 2010, section 2.5: a texture of its own for the paths that people walk on;
//            the line: Catmull and Rom 1974, "A Class of Local Interpolating Splines"
//   tested   tests/glsl/test_splat_rules.py: on the points, on a straight line, and its width
//
// The line is drawn as short straight pieces. It begins and ends as if its first and last
// point stood there twice.
#include "maths/land.glsl"
#include "maths/segment.glsl"
#include "noise/periodic.glsl"
#pragma kernel(output = "cover:r16f")

uniform vec2 first = vec2(0.0, 0.35);    //! point group("Points") Where it begins
uniform vec2 second = vec2(0.35, 0.25);  //! point group("Points") Where it goes through
uniform vec2 third = vec2(0.6, 0.6);     //! point group("Points") Where it goes through next
uniform vec2 fourth = vec2(1.0, 0.7);    //! point group("Points") Where it ends
uniform float width = 60.0;              //! log_slider(0.5, 2000) unit("m") How wide it is
uniform float verge = 30.0;              //! slider(0, 500) step(1) unit("m")
                                         //! Over how much it ends on either side
uniform float wander = 0.0;              //! slider(0, 500) step(1) unit("m")
                                         //! How far it is moved aside at random
uniform float strength = 1.0;            //! slider(0, 1) step(0.01) How much it covers

const uint SALT = 0x98bd00cbu;  // CRC-32 of "texturing/alpha_map/path"
const int PIECES = 12;  // from one point to the next

vec2 between(vec2 before, vec2 from, vec2 to, vec2 after, float t) {
    vec2 bend = 2.0 * before - 5.0 * from + 4.0 * to - after;
    vec2 twist = 3.0 * (from - to) + after - before;
    return from + 0.5 * t * (to - before + t * (bend + t * twist));
}

float kernel(ivec2 texel) {
    vec2 place = share_of_texel(texel, size) * extent;
    if (wander > 0.0) {
        vec2 bay = place / max(8.0 * width, 1.0);
        place += wander * vec2(gradient_fbm_periodic(bay, ivec2(1 << 20), 4, 0.5, SALT + 11u),
                               gradient_fbm_periodic(bay, ivec2(1 << 20), 4, 0.5, SALT + 21u));
    }
    float nearest = 1e30;
    vec2 from = first * extent;
    for (int k = 1; k <= 3 * PIECES; k++) {
        int part = (k - 1) / PIECES;
        float t = float(k - part * PIECES) / float(PIECES);
        vec2 to = part == 0 ? between(first, first, second, third, t)
                : part == 1 ? between(first, second, third, fourth, t)
                            : between(second, third, fourth, fourth, t);
        to *= extent;
        nearest = min(nearest, distance_to_segment(place, from, to));
        from = to;
    }
    float cover = verge > 0.0 ? clamp((0.5 * width - nearest) / verge + 1.0, 0.0, 1.0)
            : nearest <= 0.5 * width ? 1.0 : 0.0;
    return strength * cover;
}
