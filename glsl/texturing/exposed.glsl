// texturing/exposed.glsl -- where the ground stands out, and where it is hollow.
//
//   gives    exposed, from -1 in hollows to 1 on ridges, 0 on even slopes
//   needs    terrain/heightfield.glsl; a height
//   units    metres
//   source   the Laplacian of heights, as Zevenbergen and Thorne 1987, "Quantitative Analysis of
//            Land Surface Topography" (Earth Surface Processes and Landforms 12), has it
//   tested   tests/glsl/test_near.py, on a bowl and on planes
#include "terrain/heightfield.glsl"
#pragma kernel(output = "exposed:r16f")

uniform sampler2D height;      //! input

uniform float across = 100.0;  //! log_slider(1, 5000) unit("m") How wide what counts is
uniform float bend = 0.15;     //! slider(0.001, 2) step(0.001)
                               //! How much slopes change over that where it is half

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 place = place_on(grid, texel, size);
    // Whole texels: between them heights run straight, and a bowl would seem deeper.
    vec2 step_of = max(floor(vec2(0.5 * across) / metres + 0.5), vec2(1.0));
    vec2 far = step_of * metres;
    float here = height_at(height, place);
    float east = height_at(height, place + vec2(step_of.x, 0.0)) - here;
    float west = height_at(height, place - vec2(step_of.x, 0.0)) - here;
    float north = height_at(height, place + vec2(0.0, step_of.y)) - here;
    float south = height_at(height, place - vec2(0.0, step_of.y)) - here;
    // An edge has no other side.
    vec2 last = vec2(grid - 1);
    bool inner = all(greaterThanEqual(place, step_of))
            && all(lessThanEqual(place, last - step_of));
    float curved = relief * ((east + west) / (far.x * far.x) + (north + south) / (far.y * far.y));
    float change = inner ? -0.5 * across * curved : 0.0;
    return change / (abs(change) + bend);
}
