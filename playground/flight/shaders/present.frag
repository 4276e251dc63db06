// The frame for a screen: exposure, tone mapping, encoding.
#include "flight/scene.glsl"

uniform sampler2D picture;
uniform float exposure;
uniform int tone;
uniform float white;
uniform bool plain;
out vec4 frame;
void main() {
    vec3 light = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
    frame = vec4(plain ? light : presented(light, exposure, tone, white), 1.0);
}
