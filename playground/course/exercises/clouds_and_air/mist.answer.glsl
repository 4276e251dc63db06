// sky/ridges.glsl -- eight ridges one behind the other, with the air between.
//
//   gives    picture
//   needs    noise/gradient.glsl, sky/air.glsl
//   units    kilometres; light without unit, 1 for white
//   source   Koschmieder 1924, "Theorie der horizontalen Sichtweite": of even air, what it leaves
//            and what it adds
//   tested   tests/glsl/test_lesson_outdoors.py: at every distance, against the law in float64
#include "noise/gradient.glsl"
#include "sky/air.glsl"
#pragma kernel(output = "picture:rgba16f, distance_of:r32f")

uniform float turbidity = 2.0;  //! slider(1, 10) step(0.1) Haze: 1 none, 2 very clear, 6 hazy
uniform float nearest = 2.0;    //! log_slider(0.1, 20) unit("km") How far the first ridge is
uniform float farther = 1.75;   //! slider(1.1, 2.5) step(0.05) And each next one, times the last
uniform vec3 ground = vec3(0.045, 0.055, 0.03);  //! colour Of all ridges, as if one stood there
uniform vec3 horizon = vec3(0.62, 0.70, 0.80);   //! colour Of air that goes on for ever
uniform vec3 zenith = vec3(0.22, 0.40, 0.72);    //! colour Of the sky above
uniform uint seed = 1u;         //! slider(0, 9999) Which ridges

const int RIDGES = 8;
const uint SALT = 0x4dceca54u;  // CRC-32 of "lessons/ridges_in_air"

// How high a ridge rises in the picture, 0..1 of its height; `across` in heights of the picture.
float crest(int ridge, float across) {
    float far = float(ridge) / float(RIDGES - 1);
    float total = 0.0;
    float part = 1.0;
    for (int k = 0; k < 6; k++) {
        vec2 place = vec2(across * (1.2 + 1.6 * far), 7.3 * float(ridge));
        total += part * perlin(place * exp2(float(k)), seed + SALT).x;
        part *= 0.5;
    }
    return mix(0.10, 0.66, pow(far, 0.7)) + mix(0.14, 0.05, far) * total;
}

// anchor: air
vec3 through_air(vec3 colour, float distance_of) {
    Air air = air_of(turbidity);
    vec3 left = exp(-(air.molecules + air.aerosol + 0.1) * distance_of);
    return colour * left + horizon * (1.0 - left);
}
// end: air

void kernel(ivec2 texel, out vec4 picture, out float distance_of) {
    vec2 place = (vec2(texel) + 0.5) / float(size.y);
    distance_of = 0.0;
    picture = vec4(mix(horizon, zenith, smoothstep(0.62, 1.15, place.y)), 1.0);
    for (int ridge = RIDGES - 1; ridge >= 0; ridge--) {
        if (place.y > crest(ridge, place.x)) continue;
        distance_of = nearest * pow(farther, float(ridge));
        picture.rgb = through_air(ground, distance_of);
    }
}
