// objects/shade.glsl -- the shadows that rocks throw on the ground around the eye, from above.
//
//   gives    shade: the share of the sun that is taken away, in a square around the eye
//   needs    lighting/daylight_reading.glsl, lighting/parameters/sun.glsl, trees/quad.glsl; a list
//            of rocks
//   units    metres; 0..1
//   source   the outline of an ellipsoid around the rock's foot, along the sun, on level ground:
//            half an ellipse as in trees/shade.glsl, whose middle is the foot, and half a circle
//   tested   tests/glsl/test_undergrowth.py, against rays through ellipsoids in float64
#include "lighting/daylight_reading.glsl"
#include "trees/quad.glsl"
#pragma draw(mesh = "sheet", instances = "min(total.x, objects)", output = "shade:r16f", \
             depth = "none", blend = "alpha", samples = 1)

uniform sampler2D tree;   //! input
uniform sampler2D total;  //! input
#include "lighting/parameters/sun.glsl"
#include "objects/parameters/rocks.glsl"
#include "objects/parameters/shade.glsl"

const float SOFT = 0.2;      // of a shadow's edge, as a share of its squared radius, both ways
const float LONGEST = 6.0;   // shadows are no longer than so many heights
const float ACROSS = 0.5;    // half the width of a rock, of its height

vec4 vertex(vec3 corner, out vec2 disc, out float stretch) {
    vec4 found = tree_of(tree, gl_InstanceID);
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    if (found.w <= 0.0 || to_sun.z <= 0.0) return NOWHERE;
    float run = min(length(to_sun.xy) / to_sun.z, LONGEST);
    vec2 along = length(to_sun.xy) > 1e-5 ? -normalize(to_sun.xy) : vec2(1.0, 0.0);
    vec2 across = vec2(-along.y, along.x);
    disc = sqrt(1.0 + SOFT) * square_of(corner);
    float wide = ACROSS * found.w;
    float longer = length(vec2(wide, (1.0 - sunk) * 0.6 * found.w * run));
    stretch = longer / wide;
    vec2 place = found.xy + along * (disc.x * longer) + across * (disc.y * wide);
    return vec4((place - eye.xy) / rock_shade_wide * 2.0, 0.0, 1.0);
}

vec4 fragment(vec2 disc, float stretch) {
    // On the side of the sun there is no shadow but under the rock.
    if (disc.x < 0.0) disc.x *= stretch;
    return vec4(1.0, 0.0, 0.0, 1.0 - smoothstep(1.0 - SOFT, 1.0 + SOFT, dot(disc, disc)));
}
