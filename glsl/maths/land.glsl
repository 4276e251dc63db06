// maths/land.glsl -- where a texel is on the terrain, and on a grid of another size.
//
//   gives    share_of_texel, place_on, spacing_of, bilinear
//   needs    nothing: pure functions, no uniforms, no textures
//   units    texels; shares 0..1 of the terrain's side, east and north; metres a texel
//   source   derived here
//   tested   tests/glsl/test_maths.py: corners on corners, there and back
//
// Texels are nodes: the first and the last of a row are on the terrain's edges, so n texels
// are n - 1 spacings long. That makes grids of different sizes share their corners.
#ifndef MATHS_LAND
#define MATHS_LAND

// Where a texel is: 0 on the western and southern edge, 1 on the eastern and northern.
vec2 share_of_texel(ivec2 texel, ivec2 grid) {
    return vec2(texel) / vec2(max(grid - 1, ivec2(1)));
}

// The place on the grid `to`, in its texels, of a texel of the grid `from`.
vec2 place_on(ivec2 to, ivec2 texel, ivec2 from) {
    // Grids of one size must agree to the last bit, and some GPUs' division is not exact.
    if (from == to) return vec2(texel);
    vec2 place = vec2(texel) * vec2(to - 1) / vec2(max(from - 1, ivec2(1)));
    return min(place, vec2(to - 1));
}

// Metres from one texel of a grid to the next.
vec2 spacing_of(ivec2 grid, vec2 metres) {
    return metres / vec2(max(grid - 1, ivec2(1)));
}

// Between four corners (south-west, south-east, north-west, north-east), `part` of the way east
// and north.
float bilinear(vec4 corner, vec2 part) {
    // a + (b - a) t, not a (1 - t) + b t: between equal heights it is exactly that height.
    vec2 row = corner.xz + (corner.yw - corner.xz) * part.x;
    return row.x + (row.y - row.x) * part.y;
}
#endif
