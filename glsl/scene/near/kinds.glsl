// scene/near/kinds.glsl -- what the ground consists of: grass, stones, rock.
//
//   gives    rock_share, kinds_of_ground, grain_of_sand, kinds_of_layers, SOIL_HUE, soiled
//   needs    colour/luminance.glsl
//   units    shares that sum to 1, of grass, stones and rock; slopes in metres over metres;
//            exposed from -1 in hollows to 1 on ridges; colours linear
//   source   made here
//   tested   tests/glsl/test_near.py
//
// Ridges and dry patches are stony, hollows hold soil and grass.
#ifndef SCENE_NEAR_KINDS
#define SCENE_NEAR_KINDS
#include "colour/luminance.glsl"

const vec3 SOIL_HUE = vec3(0.215, 0.165, 0.115);
const float RIPPLE = 0.2;  // how much narrower than long ripples of sand are

// Within the two slopes, patches decide what is rock.
float rock_share(float slope, vec2 rocky, float patchy) {
    float steep = clamp((slope - rocky.x) / max(rocky.y - rocky.x, 1e-3), 0.0, 1.0);
    return smoothstep(0.42, 0.58, steep + 4.0 * patchy * steep * (1.0 - steep));
}

// Hard layers, of a tone above 0, are bare first.
vec3 kinds_of_ground(float slope, vec2 rocky, bool cliffs, float layer, float stony, float patchy,
                     float exposed) {
    float rock = cliffs ? rock_share(slope, rocky, 0.7 * patchy + layer) : 0.0;
    float stones = 1.2 * stony + 0.3 * patchy + 0.35 * exposed + 0.15 * slope;
    float bare = smoothstep(0.35, 0.85, stones);
    return vec3((1.0 - rock) * vec2(1.0 - bare, bare), rock);
}

// What draws places together along ripples of a sand that is so pure, across a wind from there.
mat2 grain_of_sand(float pure, float from) {
    vec2 wind = vec2(sin(radians(from)), cos(radians(from)));
    vec2 along = vec2(-wind.y, wind.x);
    return mat2(1.0) + (mix(1.0, RIPPLE, pure) - 1.0) * outerProduct(along, along);
}

// Of the four layers of texture splatting: grass, rock, snow and a path.
vec3 kinds_of_layers(vec4 weights) {
    return vec3(weights.x, weights.w, weights.y);
}

// A colour of the same brightness in the hue of bare soil.
vec3 soiled(vec3 colour, float share) {
    return mix(colour, SOIL_HUE * (luminance(colour) / luminance(SOIL_HUE)), share);
}
#endif
