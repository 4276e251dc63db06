// lighting/diagram/horizon/angles.glsl -- the horizons of a point, and its part of the sun.
//
//   gives    angles: texels 0 and 1, to the right and to the left: the horizon's tangent, its
//            column (-1 where there is no terrain), the tangent of the plane square to the normal,
//            the angle of the effective horizon; texel 2: the viewpoint's place and height, the
//            sun's visible part, the same by its disc's area; texel 3: the lowest height shown
//   needs    lighting/diagram/section.glsl, lighting/sun.glsl, maths/land.glsl,
//            terrain/heightfield.glsl
//   units    metres, rise over run, radians
//   source   Belaiche 2010, section 3.4: eqs 3.5, 3.6 and 3.8, figures 3.1 to 3.3
//   tested   tests/glsl/test_diagrams.py, against a loop in float64
//
// The point is one of a section of the terrain.
//
// The horizon is kept within the hemisphere of the normal: the effective one is the higher of
// the terrain's and the plane's. Eq. 3.8 takes the share of the sun's diameter for the share of
// its disc; the area is given next to it.
#include "lighting/diagram/section.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "angles:rgba32f")

uniform sampler2D height;       //! input
#include "lighting/diagram/parameters/section.glsl"
uniform int viewpoint = 32;     //! slider(0, 4096) group("Section") Column of the point that looks
#include "lighting/diagram/parameters/disc.glsl"

const float STEEPEST = 1e4;
const float HALF_PI = 1.5707963;

// The tangent of the horizon, and its column.
vec2 horizon_of(int line, int column, int side, int columns, float spacing) {
    float foot = texelFetch(height, ivec2(column, line), 0).r;
    vec2 found = vec2(-STEEPEST, -1.0);
    int count = side > 0 ? columns - 1 - column : column;
    for (int k = 1; k <= count; k++) {
        int other = column + side * k;
        float rise = (texelFetch(height, ivec2(other, line), 0).r - foot) * relief
                / (float(k) * spacing);
        if (rise > found.x) found = vec2(rise, float(other));
    }
    return found;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    int line = clamp(row, 0, grid.y - 1);
    int column = clamp(viewpoint, 0, grid.x - 1);
    float slope = slope_of_node(height, ivec2(column, line), metres, CENTRAL_DIFFERENCES).x
            * relief;
    if (texel.x == 3) {
        ivec2 shown = columns_shown(first, last, grid.x);
        float lowest = 1e30;
        for (int k = shown.x; k <= min(shown.y, grid.x - 1); k++) {
            lowest = min(lowest, texelFetch(height, ivec2(k, line), 0).r * relief);
        }
        return vec4(lowest, 0.0, 0.0, 0.0);
    }
    int side = texel.x == 1 ? -1 : 1;
    vec2 land = horizon_of(line, column, side, grid.x, metres.x);
    float plane = float(side) * slope;
    float effective = atan(max(land.x, plane));
    if (texel.x < 2) return vec4(land, plane, effective);
    float radius = max(0.5 * radians(diameter), 1e-7);
    // How many radii of the disc the horizon is above the sun's middle.
    float above = clamp((effective - radians(elevation)) / radius, -1.0, 1.0);
    float area = (acos(above) - above * sqrt(1.0 - above * above)) / (2.0 * HALF_PI);
    return vec4(float(column) * metres.x, texelFetch(height, ivec2(column, line), 0).r * relief,
                0.5 - 0.5 * above, area);
}
