// view/contours/simple.glsl -- contour lines: near an elevation of theirs, and as wide everywhere.
//
//   gives    colour, linear light, for view/map or over the terrain
//   needs    maths/land.glsl, terrain/heightfield.glsl; a height, and its slope, height per metre
//   units    elevations in metres above sea level
//   source   made here: the distance to a line is how far the elevation is from its own, over
//            how much it changes from texel to texel
//   tested   tests/glsl/test_slopes.py, against view/contours where lines do not crowd
//
// The text for reading; view/contours has thick lines, a ground, and something to show where
// lines are closer than texels.
#include "terrain/heightfield.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;  //! input
uniform sampler2D slope;   //! input("linear")

uniform float interval = 50.0;  //! log_slider(0.1, 2000) unit("m") From one line to the next
uniform int measured = 1;       //! menu("metres of height", "texels") label("Width in")
                                //! What the width counts
uniform float width = 1.6;      //! slider(0.3, 40) step(0.1) Of a line
uniform vec3 line = vec3(0.10, 0.042, 0.012);   //! colour The lines
uniform vec3 ground = vec3(0.80, 0.74, 0.62);   //! colour The ground

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    ivec2 slopes = textureSize(slope, 0);
    float elevation = base_elevation + relief * height_at(height, place_on(grid, texel, size));
    vec2 rise = relief * textureLod(slope, (place_on(slopes, texel, size) + 0.5) / vec2(slopes),
                                    0.0).rg;
    float nearest = interval * floor(elevation / interval + 0.5);
    float gap = abs(elevation - nearest);         // in metres of height
    float change = length(rise * spacing);         // metres of height from texel to texel
    if (measured == 1) gap /= max(change, 1e-6);  // in texels, along the slope
    bool fifth = mod(nearest / interval + 0.5, 5.0) < 1.0;
    float cover = clamp(0.5 * (fifth ? 2.0 * width : width) + 0.5 - gap, 0.0, 1.0);
    return vec4(mix(ground, line, cover), 1.0);
}
