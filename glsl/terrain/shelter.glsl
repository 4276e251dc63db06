// terrain/shelter.glsl -- how sheltered from the wind a place is by the ground upwind of it.
//
//   gives    shelter_at
//   needs    terrain/heightfield.glsl; the texture comes as an argument
//   units    places in texels of the texture; metres; the wind's azimuth, where it comes from,
//            clockwise from north in degrees
//   source   Winstral, Elder and Davis 2002, "Spatial Snow Modeling of Wind-Redistributed Snow
//            Using Terrain-Based Parameters", Journal of Hydrometeorology 3, eq. 1: the steepest
//            way up against the wind
//   tested   tests/glsl/test_masks.py and tests/glsl/test_near.py, in the lee of a ridge
#ifndef TERRAIN_SHELTER
#define TERRAIN_SHELTER
#include "terrain/heightfield.glsl"

const int SHELTER_LOOKS = 12;
const float SHELTERED = 0.35;  // the slope up against the wind at which the shelter is half

// -1 where the ground falls away upwind, 1 below a wall. `metres` are those of a texel, `rise`
// those of height 1, `far` how far it looks.
float shelter_at(sampler2D field, vec2 place, vec2 metres, float rise, float wind, float far) {
    vec2 upwind = vec2(sin(radians(wind)), cos(radians(wind)));
    float here = rise * height_at(field, place);
    float steepest = -1e30;
    for (int k = 1; k <= SHELTER_LOOKS; k++) {
        float run = far * float(k) / float(SHELTER_LOOKS);
        float level = rise * height_at(field, place + run * upwind / metres);
        steepest = max(steepest, (level - here) / run);
    }
    return steepest / (abs(steepest) + SHELTERED);
}
#endif
