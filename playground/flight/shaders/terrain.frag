// The ground of a part: its texture, fine grain near by, water over it, air before it.
#include "flight/scene.glsl"
#include "view.glsl"

in vec3 away;
in vec2 share;
in float depth;
in vec3 air;
uniform sampler2D ground;
uniform float width;
uniform float end;
uniform vec3 water;
uniform float clarity;
uniform bool clear;
uniform sampler2D grain;
uniform float grain_times;
out vec4 frame;
void main() {
    vec2 texels = vec2(textureSize(ground, 0));
    vec3 shown = texture(ground, (share * (texels - 1.0) + 0.5) / texels, -0.6).rgb;
    float far = length(away);
    // The grain fits a part a whole number of times, so no border shows.
    vec2 times = share * grain_times;
    shown *= close_ground(texture(grain, times), texture(grain, times * 5.0));
    if (depth > 0.0) {
        vec3 lit = water * (natural ? level_light(daylight) : vec3(1.0));
        shown = under_water(shown, depth, -away / far, lit, clarity, air);
    }
    if (!clear) shown = mix(shown, air, air_share(length(away.xy), end));
    frame = vec4(shown, 1.0);
}
