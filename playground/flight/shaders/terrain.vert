// The nodes of a part, placed around the eye.
#include "view.glsl"

in vec3 node;
uniform sampler2D heights;
uniform vec3 corner;      // the part's south-west corner at height 0, from the eye [m]
uniform float spacing;
uniform float relief;
uniform float skirt;
uniform bool is_flat;
uniform bool sea;
uniform float sea_level;  // above height 0 [m]
out vec3 away;            // from the eye [m]
out vec2 share;           // of the part, 0..1
out float depth;          // of water [m]
out vec3 air;
uniform float width;
uniform sampler2D air_table;
uniform vec2 towards_sun;
void main() {
    float up = texelFetch(heights, is_flat ? ivec2(0) : ivec2(node.xy), 0).r * relief;
    if (isnan(up) || isinf(up)) up = 0.0;
    depth = sea ? sea_level - up : -1.0;
    float surface = sea ? max(up, sea_level) : up;
    away = corner + vec3(node.xy * spacing, surface - node.z * skirt);
    share = node.xy * spacing / width;
    float aside = dot(away.xy, towards_sun) / max(length(away.xy), 1e-6);
    float entry = ((0.5 + 0.5 * aside) * (AIR_DIRECTIONS - 1.0) + 0.5) / AIR_DIRECTIONS;
    air = textureLod(air_table, vec2(entry, 0.5), 0.0).rgb;
    gl_Position = clip_from_near * vec4(away, 1.0);
}
