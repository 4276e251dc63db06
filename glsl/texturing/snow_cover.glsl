// texturing/snow_cover.glsl -- where snow lies: above a line, off cliffs, in the lee.
//
//   gives    cover, 0..1
//   needs    terrain/heightfield.glsl, terrain/shelter.glsl; a height
//   units    heights as they are, 0..1 where normalised; metres, degrees
//   source   the shelter: Winstral, Elder and Davis 2002 (terrain/shelter.glsl); the rest made
//            here
//   tested   tests/glsl/test_masks.py, on planes and in the lee of a ridge
//
// The line of the snow lies lower where the ground upwind is higher, for the wind drops there what
// it takes from where it falls away upwind.
#include "terrain/heightfield.glsl"
#include "terrain/shelter.glsl"
#pragma kernel(output = "cover:r16f")

uniform sampler2D height;     //! input

uniform float line = 0.6;     //! slider(-1, 2) step(0.01) The height at which half is covered
uniform float fade = 0.15;    //! slider(0.001, 1) step(0.001) Over how much height it begins
uniform float holds = 42.0;   //! slider(0, 90) step(0.5) unit("degrees")
                              //! Half slides off slopes so steep
uniform float holds_fade = 14.0;  //! slider(0.5, 45) step(0.5) unit("degrees")
                                  //! Over how much slope it does
uniform float wind = 270.0;   //! angle(0, 360) Where the wind comes from
uniform float drift = 0.25;   //! slider(0, 2) step(0.01)
                              //! How much lower the line is in the lee, and higher in the wind
uniform float wind_distance = 600.0;  //! log_slider(1, 20000) unit("m")
                                      //! How far upwind it looks for shelter

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    float level = height_at(height, place);
    float lower = 0.0;
    if (drift > 0.0) {
        lower = drift * shelter_at(height, place, metres, relief, wind, wind_distance);
    }
    float above = clamp((level + lower - line) / fade + 0.5, 0.0, 1.0);
    float incline = degrees(atan(relief * length(slope_at(height, place, metres,
                                                          CENTRAL_DIFFERENCES))));
    float holding = clamp((holds - incline) / holds_fade + 0.5, 0.0, 1.0);
    float cover = above * holding;
    return cover >= 0.0 ? cover : 0.0;
}
