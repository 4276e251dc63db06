// lighting/horizons.comp -- the horizons around each texel, by sweeps along lines.
//
//   gives    ahead, behind: tangents of the horizons' elevations in four directions and in the
//            four opposite; sky: K(p), the share of an even sky's light; land: the heights here
//   needs    lighting/horizons/sweep.glsl, lighting/horizons/sum.glsl, terrain/maps.glsl
//   units    tangents are rises over runs, 0 and up, at most 60000; heights without unit
//   source   Timonen and Westerholm 2010, "Scalable Height Field Self-Shadowing", section 3: of
//            the terrain that a line has passed, its upper hull is all that matters; blocks and
//            the near rows are made here
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
//   agrees   on any terrain, at the border as inside, whatever the texels' sides: never over the
//            march by more than rounding, 0.03 degrees, and under it by at most atan(0.05), 2.86
//            degrees, as derived in lighting/horizons/sweep.glsl, and rounding; so K is at most
//            0.65 * 0.05 = 0.033 too large on level ground. To rounding along axes and
//            diagonals, and wherever the horizon is at most 16 rows away. Usually much closer: by
//            0.05 degrees (rms), and by more than the sun's diameter in 1 of 500, K to 0.01, on
//            terrain from real to white noise, half of its slopes over 55 degrees
//
// Sight lines of one direction are parallel, a texel apart, and each texel of a row is on one of
// them. A sweep follows the lines from the end of the terrain that they look to, back to the
// other. Of what it has passed it keeps the upper hull: no other point can be on a horizon. So a
// texel costs a few points of a hull, however wide the terrain. Rows whose height differs much
// between the lines of sight along a line, as at a needle or at a wall, are looked at one by one:
// the rougher the terrain, the more a sweep costs.
//
// The order: first the heights are copied into an image of this pass's size, since a processor
// reads images several times faster than textures (stage 0). Then sweeps (stage 1) alternate with
// sums (stage 2, after others stage 3): a sweep leaves tangents in lines, a sum takes them from
// there to the texels. There are half as many pairs of directions as directions; no buffer may be
// larger than 128 MiB on some drivers, so that `room` says for how many pairs there are lines.
//
// A light map coarser than the heights would miss what is between its texels: give this pass
// at least as many texels as the heightmap has.
#pragma compute( \
    stages = "0, 1, 2, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, \
              1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, \
              1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3, 1, 3", \
    where = "pairs = max(directions // 8 * 4, 4 if keep else 1); \
             texels = (size.x + 32) * (size.y + 32); \
             room = max(min(2 ** 25 // texels, 8), 1); \
             rounds = (pairs - 1) // room + 1; \
             words = (max(size.x, size.y) + 31) // 8; \
             wanted = iteration <= 2 * rounds; \
             sweeps = iteration % 2; \
             groups_of_lines = (size.x + size.y + 191) // 128; \
             columns = groups_of_lines if sweeps else (size.x + 31) // 32; \
             rows = min(room, pairs) if sweeps else (size.y + 63) // 64", \
    groups = "columns if wanted else 1, rows if wanted else 1", local = "32, 1", \
    buffers = "sky:float:size.x * size.y; \
               hull:int:room * (size.x + size.y + 64) * words; \
               uncertain:int:room * (size.x + size.y + 64) * words; \
               uncertain_height:float:room * (size.x + size.y + 64) * words; \
               lines:uvec4:2 * room * (texels // 8)", \
    overwrites = "sky, land, hull, uncertain, uncertain_height, lines", aligned = "4", \
    agrees = "ahead, behind: 0.05 degrees rms; sky: 0.002 rms; exact", relief = "shown")

uniform sampler2D height;  //! input
#include "lighting/parameters/directions.glsl"
#include "lighting/parameters/normal.glsl"

#include "lighting/horizons/sum.glsl"
#include "lighting/horizons/sweep.glsl"
#include "terrain/maps.glsl"

// The heights at this pass's texels.
void copy_heights() {
    int x = int(gl_GlobalInvocationID.x);
    int end = x < size.x ? min(int(gl_WorkGroupID.y + 1u) * CHUNK, size.y) : 0;
    for (int y = int(gl_WorkGroupID.y) * CHUNK; y < end; y++) {
        float here = map_at(height, ivec2(x, y), size).r;
        imageStore(out_land, ivec2(x, y), vec4(here, 0.0, 0.0, 1.0));
    }
}

void main() {
    Batch batch = batch_at((iteration - 1) / 2);
    if (stage == 0) copy_heights();
    if (stage == 1 && batch.from < batch.end) sweep(batch);
    if (stage >= 2 && batch.from < batch.end) sum(batch, stage == 3);
}
