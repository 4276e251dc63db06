// The colour of the air on the horizon: a row of texels, by the angle from the sun.
#include "flight/scene.glsl"
#include "view.glsl"

in vec2 place;
out vec4 frame;
void main() {
    // From straight away from the sun to straight towards it: the air depends on no more.
    vec2 sun = texelFetch(daylight, ivec2(0), 0).xy;
    sun = length(sun) > 1e-9 ? normalize(sun) : vec2(0.0, 1.0);
    float aside = (gl_FragCoord.x - 0.5) / (AIR_DIRECTIONS - 1.0) * 2.0 - 1.0;
    vec2 towards = aside * sun + sqrt(max(1.0 - aside * aside, 0.0)) * vec2(-sun.y, sun.x);
    Backdrop sky = Backdrop(natural, zenith, horizon, altitude);
    frame = vec4(air_between(daylight, sky, vec3(towards, 0.03)), 1.0);
}
