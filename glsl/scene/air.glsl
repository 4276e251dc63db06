// scene/air.glsl -- the air in front of all that is seen: what it adds, and what it leaves.
//
//   gives    scattered, left: sixteen pictures each, as scene/air_reading.glsl has them; in alpha
//            the mist's depth, and its density where the slice ends
//   needs    sky/bounced.glsl, sky/slab.glsl, sky/drops.glsl, scene/air_reading.glsl,
//            scene/mist.glsl, clouds/shadow.glsl, lighting/daylight_weather.glsl; the camera; a
//            daylight and its tables, clouds if there are any
//   units    light as of lighting/daylight; what is left 0..1 a channel; of the mist per
//            kilometre
//   source   Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering
//            Technique", section 5.4; each step is sky/slab.glsl's, so it is the sky's own air
//   tested   tests/glsl/test_scene_air.py: what is left against Beer and Lambert's integral in
//            float64, the farthest slice against the sky
//
// Where clouds are wired and drawn, each step lies in their shadow or not, which shows shafts of
// light. Mist is drops that hang low: they scatter sunlight, and the light of sky and ground.
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_weather.glsl"
#include "scene/air_reading.glsl"
#include "scene/mist.glsl"
#include "sky/bounced.glsl"
#include "sky/clouds.glsl"
#include "sky/drops.glsl"
#include "sky/slab.glsl"
#pragma kernel(output = "scattered:rgba16f, left:rgba16f")

uniform sampler2D daylight;  //! input
uniform sampler2D columns;   //! input
uniform sampler2D bounced;   //! input
uniform sampler2D cloud;     //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D drift;     //! input("black")
#include "clouds/parameters/drawn.glsl"
uniform float mist = 0.0;          //! slider(0, 10) step(0.01) unit("1/km") group("Mist")
                                   //! How thick it is at its level: 4 leaves a fiftieth of what is
                                   //! a kilometre away
uniform float mist_top = 60.0;     //! log_slider(1, 2000) unit("m") group("Mist")
                                   //! Height over its level at which a third of it is left
uniform float mist_level = 0.0;    //! slider(-500, 9000) step(1) unit("m") group("Mist")
                                   //! Where it is thickest, over the terrain's height 0

const int WHOLE = 8;  // slices that are one step each; those farther away are two
const float LOWEST_SUN_IN_MIST = 0.05;  // its light comes from the side there, not from above
const float PI = 3.14159265;

// What drops add to a unit of light that they scatter: of the sun's beam, of sky and ground.
vec3 light_in_mist(float height, vec3 beam, float together, float rise, float sun_rise, vec3 sky,
                   vec3 below) {
    float scale = (1.0 - UNSCATTERED) * mist * 0.001;
    float depth = scale * mist_above(height, mist_top);
    float whole = scale * mist_above(min(height, 0.0), mist_top);
    float sine = max(sun_rise, LOWEST_SUN_IN_MIST);
    Diffuse around = diffuse_of_beam(depth, whole, sine);
    float scattered = drops_phase(together) * exp(-depth / sine) + around.mean
            + WIDE_G * around.down * rise;
    return PI * beam * scattered + diffuse_between(sky, below, depth, whole);
}

void kernel(ivec2 texel, out vec4 scattered, out vec4 left) {
    ivec2 one = max(size / 4, 1);
    ivec2 tile = min(texel / one, 3);
    int slice = tile.y * 4 + tile.x;
    vec2 share = (vec2(texel - tile * one) + 0.5) / vec2(one);
    vec4 far_point = world_from_clip * vec4(share * 2.0 - 1.0, 1.0, 1.0);
    vec3 ahead = normalize(far_point.xyz / far_point.w - eye);
    Weather now = weather(daylight);
    Sunlight from = sunlight(true, daylight, vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
    vec3 sun = from.direction;
    float together = dot(ahead, sun);
    float start = max(0.001 * (base_elevation + eye.z), 0.0);
    float mist_from = 0.001 * (base_elevation + mist_level);
    vec4 wind = texelFetch(drift, ivec2(0), 0);
    float ground = texelFetch(bounced, ivec2(0), 0).a;
    Air air = air_of(now.turbidity);
    vec3 transmittance = vec3(1.0);
    vec3 found = vec3(0.0);
    float reached = start;
    float mist_depth = 0.0;
    for (int k = 0; k < min(slice + 1, WHOLE) + 2 * max(slice + 1 - WHOLE, 0); k++) {
        int within = k < WHOLE ? k : WHOLE + (k - WHOLE) / 2;
        float first = 0.001 * slice_end(within - 1);
        float last = 0.001 * slice_end(within);
        float middle = 0.5 * (first + last);
        bool second = k >= WHOLE && ((k - WHOLE) & 1) == 1;
        float before = second ? middle : first;
        float after = k < WHOLE || second ? last : middle;
        float next = height_along(start, ahead.z, after);
        float drops = 0.0;
        if (mist > 0.0) {
            drops = mist * (after - before) * mean_mist(1000.0 * (reached - mist_from),
                                                        1000.0 * (next - mist_from), mist_top);
        }
        Slab here = slab_with_drops(columns, air, start, ahead.z, sun.z, together, before, after,
                                    drops);
        float lit = now.open;
        float beam = beam_through_clouds(1.0 - now.open);
        if (wired_cloud && wired_drift && clouds != 0) {
            lit = cloud_transmittance(cloud, wind, eye + ahead * (500.0 * (before + after)), sun);
            beam = lit;
        }
        vec3 often = bounced_at(bounced, here.height, here.sun_rise);
        vec3 once = here.molecules * phase_molecules(together)
                + here.aerosol * phase_aerosol(together);
        vec3 light = once * lit + here.share * often * now.open;
        light = PI * now.adapted * light + here.share * now.overcast * overcast(0.0);
        if (mist > 0.0) {
            vec3 sunlight_here = now.adapted * beam
                    * left_of_sunlight(columns, air, here.height, here.sun_rise);
            light += here.drops * light_in_mist(1000.0 * (0.5 * (reached + next) - mist_from),
                                                sunlight_here, together, ahead.z, here.sun_rise,
                                                from.sky, ground * now.level);
        }
        found += transmittance * light;
        transmittance *= here.left;
        reached = next;
        mist_depth += drops;
    }
    // Of the mist, its depth up to here and its density here, for what reads between two slices.
    float density = exp(-max(1000.0 * (reached - mist_from), 0.0) / mist_top);
    scattered = vec4(found, mist_depth);
    left = vec4(transmittance, mist * density);
}
