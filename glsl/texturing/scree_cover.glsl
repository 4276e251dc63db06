// texturing/scree_cover.glsl -- where scree lies: at its angle of repose, below steep faces.
//
//   gives    cover, 0..1
//   needs    terrain/heightfield.glsl; a height
//   units    degrees, metres
//   source   talus of Musgrave, Kolb and Mace 1989, section 3.3, found from the shape of the
//            ground; made here
//   tested   tests/glsl/test_masks.py, below a wall and on planes
//
// From a place on such a slope it goes up the steepest way, and looks for a face. Where the scree
// itself was made by erosion/thermal, its `deposit` says better where it is.
#include "terrain/heightfield.glsl"
#pragma kernel(output = "cover:r16f")

uniform sampler2D height;       //! input

uniform float repose = 33.0;    //! slider(5, 60) step(0.5) unit("degrees") Its angle of repose
uniform float within = 9.0;     //! slider(1, 30) step(0.5) unit("degrees")
                                //! How much flatter or steeper it may lie
uniform float face = 42.0;      //! slider(5, 89) step(0.5) unit("degrees")
                                //! Faces steeper than that let stones fall
uniform float rolls = 500.0;    //! log_slider(1, 10000) unit("m")
                                //! How far from a face stones roll

const int LOOKS = 16;

vec2 slope_there(vec2 place, vec2 metres) {
    return relief * slope_at(height, place, metres, CENTRAL_DIFFERENCES);
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    vec2 slope = slope_there(place, metres);
    float incline = degrees(atan(length(slope)));
    float lies = clamp(2.0 - 2.0 * abs(incline - repose) / within, 0.0, 1.0);
    float fed = 0.0;
    for (int k = 0; k < LOOKS; k++) {
        place += rolls / float(LOOKS) * slope / max(length(slope), 1e-6) / metres;
        place = clamp(place, vec2(0.0), vec2(grid - 1));
        slope = slope_there(place, metres);
        float steep = clamp((degrees(atan(length(slope))) - face) / 5.0 + 0.5, 0.0, 1.0);
        fed = max(fed, steep * (1.0 - float(k) / float(LOOKS)));
    }
    float cover = lies * min(2.0 * fed, 1.0);
    return cover >= 0.0 ? cover : 0.0;
}
