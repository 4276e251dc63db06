// A crown in its light, with the air in front of it.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "trees.glsl"
#include "trees/billboard.glsl"
#include "trees/wood_reading.glsl"
#include "view.glsl"

flat in mat3 on_disc;
in vec3 air_added;
in vec3 air_left;
in vec3 away;
flat in vec4 middle;
flat in vec4 form;
flat in vec3 local_eye;
flat in vec4 stand;
flat in vec3 leaves;
flat in vec2 lit;
uniform float ragged;
uniform vec2 picture;  // [pixels]
out vec4 frame;

const uint SALT = 0xc8c979e4u;  // CRC-32 of "trees/seen": the same crowns as there

void main() {
    vec2 disc = disc_of(on_disc, gl_FragCoord.xy / picture);
    CrownPoint point = crown_point(disc, middle, form, ragged, SALT, local_eye);
    if (!point.hit) discard;
    Stand around = stand_at(stand.x, stand.y);
    vec3 towards_eye = -normalize(away);
    vec2 rises = vec2(max(towards_eye.z, LOWEST), to_sun.z > 0.0 ? max(to_sun.z, LOWEST) : 0.0);
    vec2 taken = tree_light(around, drawn_of(around, stand.z), point.normal, point.place.z - stand.w,
                            towards_eye, to_sun, rises);
    vec3 light = sun_light * (leaf_phase(towards_eye, to_sun) * taken.x * lit.x * lit.y)
            + sky_light * taken.y;
    vec3 colour = point.kind == BARK ? colour_of_kind(BARK, day) : leaves;
    vec3 shown = colour * light * air_left + air_added;
    frame = vec4(before_sky(shown, away), 1.0);
}
