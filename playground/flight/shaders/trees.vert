// A tree of a part as a square towards the eye, smaller the nearer it is to where it is no longer
// drawn.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "trees.glsl"
#include "trees/billboard.glsl"
#include "view.glsl"

in vec2 corner;
in vec4 tree;
in vec3 own;
in vec2 part;             // its corner, from the eye [m]
uniform vec2 picture;     // [pixels]
flat out mat3 on_disc;    // trees/billboard: disc_of
out vec3 air_added;
out vec3 air_left;
out vec3 away;
flat out vec4 middle;
flat out vec4 form;
flat out vec3 local_eye;
flat out vec4 stand;      // density, metres above the sea, distance of the level, foot's height
flat out vec3 leaves;
flat out vec2 lit;        // what terrain and clouds leave of the sun
void main() {
    gl_Position = vec4(2.0, 2.0, 2.0, 1.0);
    // Crowns take their shape from where they stand in the part, which has few digits everywhere.
    local_eye = vec3(-part, eye_up);
    float far = length(tree.xyz - local_eye + level_eye);
    float kept = kept_share(far, whole, reach);
    if (own.x >= room * drawn_share(kept)) return;
    float small = shrunk(own.x / drawn_share(kept), drawn_part(kept), room);
    float tall = tree.w * growth_of_kept(far, whole, reach) * small * pow(room, GROWTH);
    float above_sea = tree.z + base;
    float focal = 0.5 * picture.y * length(transpose(clip_from_near)[1].xyz);
    Billboard board = billboard_of(vec4(tree.xyz, tall), corner,
                                   species_at(above_sea), local_eye, clip_from_near, focal);
    on_disc = board.disc;
    leaves = colour_of_kind(int(board.middle.w + 0.5), day);
    middle = board.middle;
    form = board.form;
    away = board.place - local_eye;
    gl_Position = clip_from_near * vec4(away, 1.0);
    Aerial before = air_before(middle.xyz - local_eye);
    air_added = before.scattered;
    air_left = before.left;
    stand = vec4(own.y, above_sea, far, tree.z);
    lit = vec2(own.z, clouds_over(middle.xyz - local_eye, 0.0));
}
