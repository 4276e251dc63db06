// lighting/diagram/beam/tests.glsl -- every test that a beam makes in a section.
//
//   gives    tests. Rows 0 and 1, the two viewpoints: texel 0 the sun's visible part, how many
//            tests, place and height; texel 1 the test of the least part (-1: none); texel 2 + k
//            the beam's height over it, its radius, the part left free, 1 if test k is made. Row
//            2, texel 0: the lowest height shown, and the terrain's highest
//   needs    lighting/diagram/section.glsl, maths/angle.glsl, maths/land.glsl; the range of the
//            heights as an input
//   units    metres
//   source   Belaiche 2010, sections 3.5.4, 4.4.1 and 4.4.2, eq. 4.3
//   tested   tests/glsl/test_diagrams.py, against a loop in float64 and against the methods
//            themselves
//
// The beam is a ray, a cylinder or a cone towards the sun.
//
// Test k is over the k-th texel towards the east. Tests end where the beam's lower side is above
// the highest height, off the terrain, or after terrain over its upper side.
#include "lighting/diagram/section.glsl"
#include "maths/angle.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "tests:rgba32f")

uniform sampler2D height;       //! input
uniform sampler2D range;        //! input
#include "lighting/diagram/parameters/beam.glsl"
#include "lighting/diagram/parameters/section.glsl"
uniform int viewpoint = 16;     //! slider(0, 4096) group("Section")
                                //! Column of the point that is lit
uniform int second = -1;        //! slider(-1, 4096) group("Section")
                                //! Column of a second one; -1: none

const int RAY = 0;
const int CYLINDER = 1;

struct Beam {
    float foot;    // metres
    float climb;   // metres a texel
    float radius;  // metres, at the viewpoint
    float growth;  // metres a texel
};

// The part that terrain of some height leaves free of the beam at a step.
float part_free(Beam ray, int k, float land) {
    float wide = ray.radius + float(k) * ray.growth;
    float above = ray.foot + float(k) * ray.climb - land;
    // A beam that is a point at its foot, and a ray anywhere, is hidden or not.
    return wide > 0.0 ? clamp(0.5 + above / (2.0 * wide), 0.0, 1.0) : above >= 0.0 ? 1.0 : 0.0;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    int line = clamp(row, 0, grid.y - 1);
    float highest = texelFetch(range, ivec2(0), 0).g * relief;
    if (texel.y >= 2) {
        ivec2 shown = columns_shown(first, last, grid.x);
        float lowest = 1e30;
        for (int k = shown.x; k <= min(shown.y, grid.x - 1); k++) {
            lowest = min(lowest, texelFetch(height, ivec2(k, line), 0).r * relief);
        }
        return vec4(lowest, highest, 0.0, 0.0);
    }
    if (texel.y == 1 && second < 0) return vec4(1.0, -1.0, 0.0, 0.0);
    int column = clamp(texel.y == 0 ? viewpoint : second, 0, grid.x - 1);
    float spacing = spacing_of(grid, extent).x;
    vec2 above = cos_sin_degrees(elevation);
    float path = spacing / max(above.x, 1e-6);
    Beam ray;
    ray.foot = texelFetch(height, ivec2(column, line), 0).r * relief;
    ray.climb = path * above.y;
    ray.radius = beam == CYLINDER ? radius / 255.0 * relief : 0.0;
    ray.growth = beam == RAY || beam == CYLINDER ? 0.0 : path * delta_r;
    int wanted = texel.x - 2;
    float seen = 1.0;
    float least = -1.0;
    int made = 0;
    bool over = false;
    for (int k = 0; column + k < grid.x && !over; k++) {
        float wide = ray.radius + float(k) * ray.growth;
        float middle = ray.foot + float(k) * ray.climb;
        if (middle - wide > highest) break;
        float part = part_free(ray, k, texelFetch(height, ivec2(column + k, line), 0).r * relief);
        if (k == wanted) return vec4(middle, wide, part, 1.0);
        if (part < seen) least = float(k);
        seen = min(seen, part);
        over = part == 0.0;
        made++;
    }
    if (texel.x == 0) return vec4(seen, float(made), float(column) * spacing, ray.foot);
    return texel.x == 1 ? vec4(least, 0.0, 0.0, 0.0) : vec4(0.0);
}
