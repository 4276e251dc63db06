// The air, the sky and the clouds around the craft, by the passes of flight/outdoors.
#include "clouds/shadow.glsl"
#include "flight/scene.glsl"
#include "scene/air_reading.glsl"
uniform sampler2D sky_picture;
uniform sampler2D scattered;
uniform sampler2D left;
uniform sampler2D cloud;
uniform vec4 wind;        // clouds/drift
uniform float open_mean;  // cloud_mean
uniform bool clouded;
uniform vec3 over_tile;   // the eye, where the clouds' tile begins [m]
uniform vec3 to_sun;
uniform mat4 outdoors_clip;  // the lens of those pictures, which may be older than this one's
uniform float end;        // of the terrain [m]

// Where in the pictures of air and sky a direction is.
vec2 share_of(vec3 away) {
    vec4 clip = outdoors_clip * vec4(away, 1.0);
    return clip.w <= 0.0 ? vec2(0.5) : clamp(0.5 + 0.5 * clip.xy / clip.w, 0.0, 1.0);
}

vec3 sky_there(vec3 away) { return eased(textureLod(sky_picture, share_of(away), 0.0).rgb); }

// The air before a vertex, `away` from the eye: it is soft, so that its pixels lie between.
Aerial air_before(vec3 away) {
    Aerial air = aerial(scattered, left, share_of(away), length(away));
    return Aerial(eased(air.scattered), air.left);
}

// What clouds leave of the sun at a vertex, over their mean (clouds/shadow.glsl). Between vertices
// so far apart no finer level of detail is read: another mesh would show other shadows.
float clouds_over(vec3 away, float apart) {
    if (!clouded) return 1.0;
    return cloud_transmittance(cloud, wind, over_tile + away, to_sun, apart) / open_mean;
}

// The terrain ends in the picture of the sky.
vec3 before_sky(vec3 shown, vec3 away) {
    float over = end_share(length(away.xy), end);
    return over > 0.0 ? mix(shown, sky_there(away), over) : shown;
}
