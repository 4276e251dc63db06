// A crown in its light, with the air in front of it.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "trees.glsl"
#include "trees/billboard.glsl"
#include "view.glsl"

in vec2 disc;
in vec3 air_added;
in vec3 air_left;
in vec3 away;
flat in vec4 middle;
flat in vec4 form;
flat in vec3 local_eye;
flat in vec4 stand;
flat in vec2 lit;
uniform float ragged;
out vec4 frame;

const uint SALT = 0xc8c979e4u;  // CRC-32 of "trees/seen": the same crowns as there

void main() {
    CrownPoint point = crown_point(disc, middle, form, ragged, SALT, local_eye);
    if (!point.hit) discard;
    Stand all = stand_at(stand.x, stand.y);
    vec3 towards_eye = over_ground(-away, vec2(0.0));
    vec2 taken = tree_light(all, drawn_of(all, stand.z), point.normal, point.place.z - stand.w,
                            towards_eye, to_sun, to_sun);
    vec3 light = sun_light * (taken.x * lit.x * lit.y) + sky_light * taken.y;
    vec3 shown = colour_of_kind(point.kind, day) * light * air_left + air_added;
    frame = vec4(before_sky(shown, away), 1.0);
}
