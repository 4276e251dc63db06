// The nodes of a part, placed around the eye, and what is soft enough to lie between them.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "view.glsl"
#include "woods.glsl"

in vec3 node;
uniform sampler2D heights;
uniform vec3 corner;      // the part's south-west corner at height 0, from the eye [m]
uniform float spacing;
uniform float relief;
uniform float skirt;
uniform bool is_flat;
uniform bool sea;
uniform float sea_level;  // above height 0 [m]
uniform float width;
out vec3 away;            // from the eye [m]
out vec2 share;           // of the part, 0..1
out float depth;          // of water [m]
out vec3 air_added;
out vec3 air_left;
out vec2 light_left;      // of sun and sky, what clouds and leaves let through
out float hides;          // woods/Wood
out vec3 wood_shown;
void main() {
    float up = texelFetch(heights, is_flat ? ivec2(0) : ivec2(node.xy), 0).r * relief;
    if (isnan(up) || isinf(up)) up = 0.0;
    depth = sea ? sea_level - up : -1.0;
    float surface = sea ? max(up, sea_level) : up;
    away = corner + vec3(node.xy * spacing, surface - node.z * skirt);
    share = node.xy * spacing / width;
    gl_Position = clip_from_near * vec4(away, 1.0);
    float apart = 0.5 * skirt;
    air_added = vec3(0.0);
    air_left = vec3(1.0);
    light_left = vec2(1.0);
    if (natural) {
        Aerial before = air_before(away);
        air_added = before.scattered;
        air_left = before.left;
        light_left.x = clouds_over(away, apart);
    }
    hides = 0.0;
    wood_shown = vec3(0.0);
    if (wooded) {
        vec2 nodes = vec2(textureSize(woods, 0));
        // As coarse as the mesh, by the level of detail.
        float level = log2(max(apart * (nodes.x - 1.0) / width, 1.0));
        vec2 here = textureLod(woods, (share * (nodes - 1.0) + 0.5) / nodes, level).rg;
        Wood wood = wood_from(away, up + base, here, light_left.x);
        hides = wood.hides;
        wood_shown = wood.light;
        light_left *= wood.below;
    }
}
