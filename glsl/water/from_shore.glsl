// water/from_shore.glsl -- a lake from its shore: mirror, bed and waves.
//
//   gives    picture; mirrored: the share of the light that the surface mirrors; slope: its own
//   needs    noise/gradient.glsl, noise/hash.glsl, water/body.glsl, water/fresnel.glsl
//   units    metres; light without unit, 1 for white
//   source   Fresnel's equations, Snell's law and that of Beer and Lambert; slopes of waves: Cox
//            and Munk 1954, "Measurement of the Roughness of the Sea Surface from Photographs of
//            the Sun's Glitter", J. Opt. Soc. Am. 44(11)
//   tested   tests/glsl/test_lesson_outdoors.py: calm water against Fresnel, Snell and Beer in
//            float64; the variance of the slopes against Cox and Munk
//
// One ray a pixel into a scene of formulas; scene/water draws the same over a terrain.
#include "noise/gradient.glsl"
#include "noise/hash.glsl"
#include "water/body.glsl"
#include "water/fresnel.glsl"
#pragma kernel(output = "picture:rgba16f, mirrored:r32f, slope:rg32f")

uniform float wind = 0.0;        //! slider(0, 12) step(0.1) unit("m/s") The more, the rougher
uniform float clarity = 8.0;     //! log_slider(0.5, 18) unit("m")
                                 //! Depth at which a third of the green light is left
uniform float shelving = 0.16;   //! slider(0, 1) step(0.01) Metres that the bed falls in a metre
uniform float eye_height = 2.0;  //! log_slider(0.5, 50) unit("m") Over the water
uniform float down = 14.0;       //! slider(0, 60) step(0.5) unit("°") How far down the eye looks
uniform vec2 sun = vec2(8.0, 24.0);  //! slider(-60, 90) parts("right", "up") unit("°")
                                 //! Where the sun stands, from where the eye looks

const int WAVES = 24;
const float LONGEST = 6.0, SHORTEST = 0.12;  // [m]
const uint SALT = 0x1f08c0e3u;               // CRC-32 of "lessons/water_view"
const vec3 DEEP = vec3(0.010, 0.035, 0.040); // what deep water sends back of white light

vec3 towards_the_sun() {
    vec2 angles = radians(sun);
    return vec3(sin(angles.x) * cos(angles.y), cos(angles.x) * cos(angles.y), sin(angles.y));
}

// The sky and the far shore, in any direction.
vec3 sky_in(vec3 ahead) {
    float aside = atan(ahead.x, ahead.y);
    float hills = 0.075 + 0.05 * perlin(vec2(4.0 * aside, 0.5), SALT).x
                + 0.015 * perlin(vec2(23.0 * aside, 1.5), SALT).x;
    vec3 sky = mix(vec3(0.72, 0.76, 0.78), vec3(0.16, 0.32, 0.62), smoothstep(0.0, 0.7, ahead.z));
    float off = acos(clamp(dot(ahead, towards_the_sun()), -1.0, 1.0));
    sky += vec3(1.0, 0.9, 0.7) * (6.0 * smoothstep(0.03, 0.02, off) + 0.35 * exp(-9.0 * off));
    vec3 wood = vec3(0.055, 0.075, 0.03) + 0.02 * perlin(60.0 * vec2(aside, ahead.z), SALT).x;
    return ahead.z < hills ? mix(wood, vec3(0.5, 0.56, 0.62), 0.25) : sky;
}

// Pebbles on the bed.
vec3 bed_at(vec2 place) {
    float many = perlin(place / 0.35, SALT + 2u).x + 0.6 * perlin(place / 0.13, SALT + 3u).x;
    return vec3(0.34, 0.29, 0.21) * (1.0 + 0.45 * many);
}

// The mean square of each wave's slope is the same share of Cox and Munk's; those that a pixel
// of a width cannot show are left out.
vec2 slope_at(vec2 place, float pixel) {
    // anchor: waves
    float variance = 0.00512 * wind;
    vec2 slope = vec2(0.0);
    for (int k = 0; k < WAVES; k++) {
        vec2 drawn_by_lot = random_pair(ivec2(k, 0), SALT);
        float length_of = LONGEST * pow(SHORTEST / LONGEST, float(k) / float(WAVES - 1));
        float angle = 2.2 * (drawn_by_lot.x - 0.5);
        vec2 ahead = vec2(sin(angle), -cos(angle));
        float turns = dot(ahead, place) / length_of + drawn_by_lot.y
                    - sqrt(9.81 / (6.2831853 * length_of)) * time;
        float shown = clamp(length_of / (2.0 * pixel) - 1.0, 0.0, 1.0);
        slope += shown * sqrt(2.0 * variance / float(WAVES)) * ahead * cos(6.2831853 * turns);
    }
    // end: waves
    return slope;
}

// Light of the bed, through as much water as lies on the way down and up again.
vec3 light_below(vec2 place, vec3 ahead, vec3 normal, float depth) {
    // anchor: below
    vec3 bent = refract(ahead, normal, 1.0 / WATER_INDEX);
    float path = depth / max(-bent.z, 0.2);
    vec3 left = exp(-attenuation_of(clarity) * (path + depth));
    return bed_at(place + bent.xy * path) * left + DEEP * (1.0 - left);
    // end: below
}

void kernel(ivec2 texel, out vec4 picture, out float mirrored, out vec2 slope) {
    vec2 off = (vec2(texel) + 0.5 - 0.5 * vec2(size)) / float(size.y);
    float sinks = radians(down);
    vec3 ahead = normalize(vec3(off.x, cos(sinks) + off.y * sin(sinks),
                                off.y * cos(sinks) - sin(sinks)));
    picture = vec4(sky_in(ahead), 1.0);
    mirrored = 0.0;
    slope = vec2(0.0);
    if (ahead.z >= -1e-4) return;
    float far = eye_height / -ahead.z;
    vec2 place = ahead.xy * far;
    slope = slope_at(place, far / float(size.y) / -ahead.z);
    // anchor: surface
    vec3 normal = normalize(vec3(-slope, 1.0));
    mirrored = fresnel_of_water(dot(normal, -ahead));
    vec3 above = sky_in(abs(reflect(ahead, normal)) * vec3(sign(ahead.xy), 1.0));
    vec3 below = light_below(place, ahead, normal, shelving * max(place.y - 2.0, 0.0));
    picture.rgb = mix(below, above, mirrored);
    // end: surface
}
