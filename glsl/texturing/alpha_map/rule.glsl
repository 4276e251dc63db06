// texturing/alpha_map/rule.glsl -- where a layer lies, by height, slope and curvature.
//
//   gives    cover, 0..1
//   needs    noise/periodic.glsl, terrain/heightfield.glsl, texturing/alpha_map/curvature.glsl; a
//            height
//   units    heights as they are, 0..1 where normalised; slopes in degrees; curvature in 1/km,
//            above 0 in a hollow; a fade in the unit of what fades
//   source   Belaiche 2010, section 2.5: rock on the hills, grass or mud on the level, snow on
//            the tops; thresholds, fades and curvature made here
//   tested   tests/glsl/test_splat_rules.py, against terrain of one height, slope or curvature
//
// Three bands, multiplied: a layer covers where height, slope and curvature all lie in
// theirs. A band's edges fade over a stretch that has the edge in its middle; chance moves
// the edges by as much of it as `ragged` says.
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#include "texturing/alpha_map/curvature.glsl"
#pragma kernel(output = "cover:r16f")

uniform sampler2D height;  //! input

uniform float height_from = -1.0;     //! slider(-1, 2) step(0.01) group("Height") label("From")
                                      //! Lower terrain has none of it; -1: no terrain is too low
uniform float height_to = 2.0;        //! slider(-1, 2) step(0.01) group("Height") label("To")
                                      //! Higher terrain has none of it; 2: no terrain is too high
uniform float height_fade = 0.1;      //! slider(0, 1) step(0.01) group("Height") label("Fade")
                                      //! Over how much height it begins and ends
uniform float slope_from = 0.0;       //! slider(0, 90) step(0.5) unit("degrees") group("Slope")
                                      //! label("From")
                                      //! Flatter terrain has none of it
uniform float slope_to = 90.0;        //! slider(0, 90) step(0.5) unit("degrees") group("Slope")
                                      //! label("To")
                                      //! Steeper terrain has none of it
uniform float slope_fade = 10.0;      //! slider(0, 45) step(0.5) unit("degrees") group("Slope")
                                      //! label("Fade")
                                      //! Over how much slope it begins and ends
uniform bool by_curvature = false;    //! group("Curvature") Whether it looks for hollows or crests
uniform float curvature_from = 0.0;   //! slider(-20, 20) step(0.1) unit("1/km") group("Curvature")
                                      //! label("From")
                                      //! Terrain that bends up less has none of it; above 0,
                                      //! hollows alone
uniform float curvature_to = 20.0;    //! slider(-20, 20) step(0.1) unit("1/km") group("Curvature")
                                      //! label("To")
                                      //! Terrain that bends up more has none of it; below 0,
                                      //! crests alone
uniform float curvature_fade = 1.0;   //! slider(0, 10) step(0.1) unit("1/km") group("Curvature")
                                      //! label("Fade")
                                      //! Over how much curvature it begins and ends
uniform float curvature_distance = 60.0;  //! log_slider(1, 2000) unit("m") group("Curvature")
                                      //! label("Distance")
                                      //! How far away the terrain is looked at
uniform float strength = 1.0;         //! slider(0, 1) step(0.01) How much it covers where it does
uniform float ragged = 0.0;           //! slider(0, 4) step(0.05) group("Chance")
                                      //! How far the edges move at random, in fades
uniform float grain = 80.0;           //! log_slider(1, 2000) unit("m") group("Chance")
                                      //! How wide the largest of its bays are
uniform uint seed = 1u;               //! slider(0, 9999) group("Chance") Which random numbers

const uint SALT = 0xef495a59u;  // CRC-32 of "texturing/alpha_map"

// 0 below a band, 1 inside, 0 above; an edge that does not fade is a step.
float band(float value, float from, float to, float fade, float moved) {
    float wide = max(fade, 1e-6);
    float begun = clamp((value - from) / wide + 0.5 + moved, 0.0, 1.0);
    float ended = clamp((to - value) / wide + 0.5 + moved, 0.0, 1.0);
    return begun * ended;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    float level = height_at(height, place);
    float incline = degrees(atan(length(relief
                                        * slope_at(height, place, metres, CENTRAL_DIFFERENCES))));
    float moved = 0.0;
    if (ragged > 0.0) {
        vec2 bay = share_of_texel(texel, size) * extent / grain;
        moved = ragged * gradient_fbm_periodic(bay, ivec2(1 << 20), 5, 0.6, 64u * seed + SALT);
    }
    // At the ends of their ranges thresholds are no edges: nothing is flatter than level.
    float cover = band(level, height_from > -1.0 ? height_from : -1e6,
                       height_to < 2.0 ? height_to : 1e6, height_fade, moved)
                * band(incline, slope_from > 0.0 ? slope_from : -1e6,
                       slope_to < 90.0 ? slope_to : 1e6, slope_fade, moved);
    if (by_curvature) {
        float bend = 1000.0 * relief * curvature_at(height, place, metres, curvature_distance);
        cover *= band(bend, curvature_from, curvature_to, curvature_fade, moved);
    }
    // Terrain that is not a number has no cover, so that it stays visible as such in the view.
    return cover >= 0.0 ? strength * cover : 0.0;
}
