// The sky, where no terrain was drawn.
#include "flight/scene.glsl"
#include "view.glsl"

in vec2 place;
out vec4 frame;
void main() {
    vec4 away = near_from_clip * vec4(place, 1.0, 1.0);
    Backdrop sky = Backdrop(natural, zenith, horizon, altitude);
    frame = vec4(backdrop_towards(daylight, sky, normalize(away.xyz / away.w), pixel), 1.0);
}
