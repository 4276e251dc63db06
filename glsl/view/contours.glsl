// view/contours.glsl -- lines of equal elevation, as wide everywhere, over a colour.
//
//   gives    colour, linear light, for view/map or over the terrain
//   needs    terrain/heightfield.glsl; a height, and a colour if there is one
//   units    elevations in metres above sea level; widths in texels of this pass
//   source   made here: the distance to a line is how far the elevation is from its own, over
//            how much it changes from texel to texel
//   tested   tests/glsl/test_view_contours.py, against lines on planes and cones in float64
//
// Where lines would lie closer than they can be distinguished, the mean of lines and ground
// replaces them. Level ground has no line, even where it lies at the elevation of one.
#include "terrain/heightfield.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;  //! input
uniform sampler2D colour;  //! input("linear", "mipmap", "white")

uniform float interval = 50.0;    //! log_slider(0.1, 2000) unit("m") From one line to the next
uniform int every = 5;            //! slider(0, 20) label("Thick lines")
                                  //! Every so manieth line is thick; 0: none
uniform float width = 1.1;        //! slider(0.3, 8) step(0.1) unit("texels") Of a line
uniform float thick = 2.2;        //! slider(0.3, 12) step(0.1) unit("texels") Of a thick line
uniform vec3 line = vec3(0.10, 0.042, 0.012);  //! colour The lines
uniform float strength = 0.85;    //! slider(0, 1) step(0.01) How much of the ground a line hides

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    float elevation = base_elevation + relief * height_at(height, place);
    // Metres up from one texel of this pass to the next, along the slope.
    vec2 steps = relief * slope_at(height, place, spacing_of(grid, extent), CENTRAL_DIFFERENCES)
            * spacing_of(size, extent);
    float change = length(steps);
    float number = floor(elevation / interval + 0.5);
    float gap = abs(elevation - number * interval) / max(change, 1e-20);
    bool is_thick = every > 0 && abs(number - float(max(every, 1))
                                     * floor(number / float(max(every, 1)) + 0.5)) < 0.5;
    float wide = is_thick ? thick : width;
    float cover = clamp(0.5 * wide + 0.5 - gap, 0.0, 1.0) * min(wide, 1.0);
    float crowd = change / interval;  // lines in a texel
    float mean = min(crowd * (every > 0 ? mix(width, thick, 1.0 / float(max(every, 1))) : width),
                     1.0);
    cover = mix(cover, mean, smoothstep(0.25, 0.5, crowd));
    if (!(change > 1e-6 * interval)) cover = 0.0;

    ivec2 ground_size = textureSize(colour, 0);
    float level = max(log2(float(ground_size.x - 1) / float(max(size.x - 1, 1))), 0.0);
    vec3 ground = textureLod(colour, (place_on(ground_size, texel, size) + 0.5)
                             / vec2(ground_size), level).rgb;
    return vec4(mix(ground, line, strength * cover), 1.0);
}
