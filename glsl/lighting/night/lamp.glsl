// lighting/night/lamp.glsl -- a lamp on the land adds its light, with shadows.
//
//   gives    light: that of the moon, and the lamp's; alpha as it came
//   needs    lighting/sun.glsl, lighting/walk.glsl; the land's tops as an input
//   units    light without unit, 1 for white; metres
//   source   beyond Belaiche 2010, section 5.4.2, which says that lamps are near and takes them for far;
//            the inverse square law; the soft falloff made here
//   tested   tests/glsl/test_shadows.py, against NumPy
//
// From each texel a walk goes to the lamp, which is a small ball: a cone from the texel around
// it, as in soft_cone, gives its free part. With inverse square falloff `reach` is how far off the
// lamp is as bright as its gain; with the soft one it is where the light ends.
#include "lighting/sun.glsl"
#include "lighting/walk.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                 //! input
uniform sampler2D tops;                   //! input
uniform sampler2D moonlit;                //! input
uniform vec2 lamp = vec2(0.5);            //! point group("Lamp") Where it stands
uniform float lamp_height = 40.0;         //! slider(0, 2000) step(1) group("Lamp") unit("m") How high over the ground
uniform float lamp_radius = 1.0;          //! slider(0, 100) step(0.5) group("Lamp") unit("m") A large one throws soft shadows
uniform vec3 lamp_colour = vec3(1.0, 0.6, 0.25);  //! colour group("Lamp") Colour of its light
uniform float lamp_gain = 0.0;            //! slider(0, 8) step(0.05) group("Lamp") Its light is multiplied by it; at 0 there is none
uniform float reach = 800.0;              //! log_slider(1, 100000) group("Lamp") unit("m") How far it shines
uniform int falloff = 0;                  //! menu("inverse square", "soft") group("Lamp") How its light falls off; the soft way ends at its reach
uniform int normal = 0;                   //! menu("central differences", "one triangle") How the slope is found; the thesis takes one triangle, to one side

const float BRIGHTEST = 1000.0;  // over its gain, close by, where the inverse square has no bound

float falling_off(float distance_to) {
    float share = distance_to / reach;
    if (falloff == 1) return pow(max(1.0 - share * share, 0.0), 2.0);
    return min(1.0 / max(share * share, 1e-12), BRIGHTEST);
}

// The free part of the ball over a walk of so many steps.
float seen(Walk walk, int count, float grows, bool on_lines) {
    float part = 1.0;
    int k = 1;
    while (k <= count) {
        int to;
        k = next_near(tops, walk, k, count, 0.0, walk.climb - grows, relief, to);
        for (; k < to; k++) {
            float t = float(k);
            float over = walk.foot + t * walk.climb - height_at_step(height, walk, k, INTERPOLATED, on_lines) * relief;
            part = min(part, clamp(0.5 + over / max(2.0 * t * grows, 1e-20), 0.0, 1.0));
            if (part == 0.0) return 0.0;
        }
    }
    return part;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    vec2 stand = lamp * vec2(grid - 1);
    float foot = height_at(height, place) * relief;
    vec3 way = vec3((stand - place) * metres, height_at(height, stand) * relief + lamp_height - foot);
    // In the lamp itself, and on a land of one texel, all ways to it are as good: upwards.
    float far = max(length(way), 1e-3);
    way = length(way) < 1e-3 ? vec3(0.0, 0.0, 1.0) : way / far;
    vec2 slope = relief * slope_at(height, place, metres, normal);
    float received = lamp_gain * max(0.0, dot(normal_of_slope(slope), way)) * falling_off(far);
    Walk walk = walk_from(place, foot, way, grid, metres, 1.0, size == grid);
    // Steps before the lamp; none where it sends no light.
    int count = received > 0.0 ? min(walk.count, int(ceil(far / walk.path)) - 1) : 0;
    float grows = walk.path * lamp_radius / far;
    float part = walk.on_lines ? seen(walk, walk.on_lines ? count : 0, grows, true) : seen(walk, walk.on_lines ? 0 : count, grows, false);
    vec4 moon = texelFetch(moonlit, texel, 0);
    return vec4(moon.rgb + lamp_colour * (received * part), moon.a);
}
