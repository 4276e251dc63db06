// The ground of a part: its texture, fine grain near by, woods far away, water over it, air before
// it.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "view.glsl"

in vec3 away;
in vec2 share;
in float depth;
in vec3 air_added;
in vec3 air_left;
in vec2 light_left;
in float hides;
in vec3 wood_shown;
uniform sampler2D ground;
uniform sampler2D woods;
uniform bool wooded;
uniform vec3 water;
uniform float clarity;
uniform bool clear;
uniform sampler2D grain;
uniform float grain_times;
uniform sampler2D air_table;
uniform vec2 towards_sun;
out vec4 frame;

// The air on the horizon in the direction that is looked in.
vec3 air_there() {
    float aside = dot(away.xy, towards_sun) / max(length(away.xy), 1e-6);
    float entry = ((0.5 + 0.5 * aside) * (AIR_DIRECTIONS - 1.0) + 0.5) / AIR_DIRECTIONS;
    return textureLod(air_table, vec2(entry, 0.5), 0.0).rgb;
}

void main() {
    vec2 texels = vec2(textureSize(ground, 0));
    // In alpha, how much of the light comes straight from the sun.
    vec4 lit = texture(ground, (share * (texels - 1.0) + 0.5) / texels, -0.6);
    vec3 shown = lit.rgb * mix(light_left.y, light_left.x, lit.a);
    if (wooded) {
        vec2 nodes = vec2(textureSize(woods, 0));
        float density = texture(woods, (share * (nodes - 1.0) + 0.5) / nodes).r;
        shown = mix(wood_shown, shown, exp(-hides * density));
    }
    // The grain fits a part a whole number of times, so no border shows.
    vec2 times = share * grain_times;
    shown *= close_ground(texture(grain, times), texture(grain, times * 5.0));
    if (depth > 0.0) {
        vec3 below = water * (natural ? level_light(daylight) : vec3(1.0));
        shown = under_water(shown, depth, -normalize(away), below, clarity, air_there());
    }
    if (natural && !clear) {
        shown = before_sky(shown * air_left + air_added, away);
    } else if (!clear) {
        shown = mix(shown, air_there(), air_share(length(away.xy), end));
    }
    frame = vec4(shown, 1.0);
}
