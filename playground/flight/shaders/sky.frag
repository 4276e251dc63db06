// The sky, where no terrain was drawn.
#include "flight/scene.glsl"
#include "outdoors.glsl"
#include "view.glsl"

in vec2 place;
out vec4 frame;
void main() {
    vec4 away = near_from_clip * vec4(place, 1.0, 1.0);
    Backdrop sky = Backdrop(natural, zenith, horizon, altitude);
    vec3 shown = natural ? sky_there(away.xyz / away.w)
            : backdrop_towards(sky, normalize(away.xyz / away.w));
    frame = vec4(shown, 1.0);
}
