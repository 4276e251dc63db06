// lighting/night/lamp.glsl -- a lamp on the terrain adds its light, with shadows.
//
//   gives    light: that of the moon, and the lamp's; alpha as it came
//   needs    lighting/march.glsl, lighting/parameters/normal.glsl, lighting/sun.glsl
//   units    light without unit, 1 for white; metres
//   source   beyond Belaiche 2010, section 5.4.2, which says that lamps are near and takes them
//            for far; the inverse square law; the soft falloff made here
//   tested   tests/glsl/test_shadows.py, against NumPy
//
// From each texel a ray goes to the lamp, which is a small ball: a cone from the texel around
// it, as in soft_cone, gives its free part. With inverse square falloff the lamp is as bright as
// its gain at `max_distance`; with the soft one the light ends there.
#include "lighting/march.glsl"
#include "lighting/sun.glsl"
#pragma kernel(output = "light:rgba16f", relief = "shown")

uniform sampler2D height;        //! input
uniform sampler2D moonlit;       //! input
uniform vec2 lamp = vec2(0.5);   //! point group("Lamp") Where it is
uniform float lamp_height = 40.0;  //! slider(0, 2000) step(1) group("Lamp") unit("m")
                                   //! How high over the ground
uniform float lamp_radius = 1.0;   //! slider(0, 100) step(0.5) group("Lamp") unit("m")
                                   //! A large one throws soft shadows
uniform vec3 lamp_colour = vec3(1.0, 0.6, 0.25);  //! colour group("Lamp") Colour of its light
uniform float lamp_gain = 0.0;   //! slider(0, 8) step(0.05) group("Lamp")
                                 //! Its light is multiplied by it; at 0 there is none
uniform float max_distance = 800.0;  //! log_slider(1, 100000) group("Lamp") unit("m")
                                     //! How far it shines
uniform int falloff = 0;         //! menu("inverse square", "soft") group("Lamp")
                                 //! How its light falls off; "soft" ends at the max distance
#include "lighting/parameters/normal.glsl"

const float BRIGHTEST = 1000.0;  // over its gain, close by, where the inverse square has no bound

float falling_off(float distance_to) {
    float share = distance_to / max_distance;
    if (falloff == 1) return pow(max(1.0 - share * share, 0.0), 2.0);
    return min(1.0 / max(share * share, 1e-12), BRIGHTEST);
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    vec2 stand = lamp * vec2(grid - 1);
    float foot = height_at(height, place) * relief;
    float rise = height_at(height, stand) * relief + lamp_height - foot;
    vec3 to_lamp = vec3((stand - place) * metres, rise);
    // In the lamp itself, and on a terrain of one texel, any direction will do: upwards.
    float far = max(length(to_lamp), 1e-3);
    to_lamp = length(to_lamp) < 1e-3 ? vec3(0.0, 0.0, 1.0) : to_lamp / far;
    vec2 slope = relief * slope_at(height, place, metres, normal);
    // anchor: lamp
    float facing = max(0.0, dot(normal_of_slope(slope), to_lamp));
    float received = lamp_gain * facing * falling_off(far);
    March march = march_from(height, place, to_lamp, extent, relief, 1.0);
    // Steps before the lamp; none where it sends no light.
    int count = received > 0.0 ? min(march.count, int(ceil(far / march.path)) - 1) : 0;
    float radius_a_step = march.path * lamp_radius / far;
    // end: lamp
    float part = 1.0;  // of the ball, free
    for (int i = 1; i <= count && part > 0.0; i++) {
        float ray = march.foot + float(i) * march.climb;
        float clearance = ray - terrain_at(height, march, i, INTERPOLATED);
        float radius = float(i) * radius_a_step;
        part = min(part, clamp(0.5 + clearance / max(2.0 * radius, 1e-20), 0.0, 1.0));
    }
    vec4 moon = texelFetch(moonlit, texel, 0);
    return vec4(moon.rgb + lamp_colour * (received * part), moon.a);
}
