// generation/circles/by_tiles.glsl -- domes added to the terrain, tile by tile.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/circles/dome.glsl, generation/marks.glsl, maths/whole.glsl
//   units    heights without unit
//   source   the sum of generation/circles/raw.glsl
//   tested   tests/glsl/test_marks.py, as part of the fast variant
#include "generation/circles/dome.glsl"
#include "generation/marks.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D disc;      //! input
uniform sampler2D touching;  //! input
uniform int discs = 200;     //! slider(0, 1000) As in the technique
uniform int dome = 0;        //! menu("half a cosine", "half a sphere") As in the technique

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing / shorter_side(extent);
    ivec3 grid = tile_grid(textureSize(touching, 0), discs);
    ivec2 last = max(size - 1, ivec2(1));
    ivec2 tile = ivec2(quotient(texel.x * grid.x, last.x), quotient(texel.y * grid.y, last.y));
    tile = min(tile, grid.xy - 1);
    float height = 0.0;
    for (int block = 0; block < grid.z; block++) {
        ivec2 at = ivec2(block * grid.x + tile.x, tile.y);
        Marks marks = marks_of(texelFetch(touching, at, 0), block * MARKS);
        while (some_left(marks)) {
            int which = next_mark(marks);
            if (which >= 0) {
                vec4 one = texelFetch(disc, ivec2(which, 0), 0);
                float share = disc_share(place - one.xy, one.z);
                if (share < 1.0) height += one.w * dome_of_share(share, dome == 1);
            }
        }
    }
    return height;
}
