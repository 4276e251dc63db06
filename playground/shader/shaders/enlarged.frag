#version 330
// A picture enlarged along its rows, or along its columns. Between the middles of its texels lies
// the cubic of Catmull and Rom 1974, "A Class of Local Interpolating Splines", which goes through
// their values and keeps edges sharp. Texels are fetched: a bound sampler changes nothing.
// Which way, and whether the picture has one channel, are constants: a software renderer works out
// places of texels, and chooses channels, for each of the four anew.
uniform sampler2D picture;
uniform float times;  // pixels of the target that a texel is wide, along `way`
out vec4 colour;

const ivec2 way = ivec2($way);  // 1, 0 along rows; 0, 1 along columns
const bool grey = $grey;

vec3 texel(ivec2 at) {
    vec4 found = texelFetch(picture, at, 0);
    return grey ? found.rrr : found.rgb;
}

void main() {
    float place = dot(vec2(way), gl_FragCoord.xy) / times - 0.5;
    float first = floor(place), t = place - first;
    vec4 weight = 0.5 * vec4(((2.0 - t) * t - 1.0) * t, (3.0 * t - 5.0) * t * t + 2.0,
                             ((4.0 - 3.0 * t) * t + 1.0) * t, (t - 1.0) * t * t);
    ivec2 across = ivec2(gl_FragCoord.xy) * (1 - way), size = textureSize(picture, 0);
    ivec4 along = clamp(int(first) + ivec4(-1, 0, 1, 2), 0, way.x * size.x + way.y * size.y - 1);
    vec3 found = weight.x * texel(across + way * along.x) + weight.y * texel(across + way * along.y)
            + weight.z * texel(across + way * along.z) + weight.w * texel(across + way * along.w);
    colour = vec4(found, 1.0);
}
