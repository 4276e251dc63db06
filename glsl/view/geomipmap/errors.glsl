// view/geomipmap/errors.glsl -- how far each level of a tile lies from the terrain.
//
//   gives    spans: lowest and highest height of a tile, and the shares of the terrain's sides
//            where it ends, east and north; errors: of levels 1, 2, 3 and 4
//   needs    view/geomipmap/tiles.glsl; a height
//   units    of the height, but for shares 0..1
//   source   Belaiche 2010, section 2.5; de Boer 2000, "Fast Terrain Rendering Using Geometrical
//            MipMapping", for the error of a level as the largest height between it and the
//            terrain
//   tested   tests/glsl/test_view_geomipmap.py, against planes through the corners of each
//            triangle in float64, with every set of coarser neighbours
//
// A level's triangles lie as fans around the middles of blocks of 2 x 2 quads; a coarser
// neighbour takes the middle of a block's side out of the fan, so two triangles become one.
// So each triangle of any such mesh is made of whole triangles of any finer one, and two
// meshes of a tile lie farthest apart at a node of the finer one, which is on the terrain. That
// is why an error, taken over all nodes, is the largest jump to any finer level as well, and
// why a level that fits within a number of pixels changes within that number. What lies on
// the side itself counts for the neighbour, whose triangles end there too.
//
// In a tile that the terrain's edge cuts, the quads next to it are narrower, and triangles of two
// levels may cross: there an error is that at the nodes.
//
// A level is no better than the finer ones: each has at least the error of those.
#include "view/geomipmap/tiles.glsl"
#pragma kernel(output = "spans:rgba32f, errors:rgba32f")

uniform sampler2D height;  //! input

// A tile with a height that is not a number stays whole, so that the hole is as small as it is.
const float NEVER = 1e30;

// The heights of the tile, fetched once: each is needed for every level.
const int ROW = TILE + 1;
float nodes[ROW * ROW];

float node(ivec2 at) {
    return nodes[at.y * ROW + at.x];
}

// The corners and the middles of a block's sides, counter-clockwise from the south-west; even ones
// are corners.
ivec2 around(int k, int half_side) {
    ivec2 side = ivec2(k >= 2 && k <= 4 ? 1 : k == 1 || k == 5 ? 0 : -1,
                       k >= 4 && k <= 6 ? 1 : k == 3 || k == 7 ? 0 : -1);
    return side * half_side;
}

// The largest error of the fans of one block of a tile of `cells`; `middle` is counted from its
// corner.
float error_of_block(ivec2 middle, int half_side, ivec2 cells) {
    float ring[8];
    for (int k = 0; k < 8; k++) ring[k] = node(middle + around(k, half_side));
    float centre = node(middle);
    // How far the fans go from their middle, west and south, east and north.
    ivec2 at = min(middle, cells);
    ivec2 low = at - min(middle - half_side, cells);
    ivec2 high = min(middle + half_side, cells) - at;
    float worst = 0.0;
    for (int y = -low.y; y <= high.y; y++) {
        for (int x = -low.x; x <= high.x; x++) {
            float truth = node(at + ivec2(x, y));
            // Four sectors, each with a side: how far out towards it, and how far along it.
            ivec2 half_extent = ivec2(x < 0 ? low.x : high.x, y < 0 ? low.y : high.y);
            vec2 direction = vec2(x, y) / vec2(max(half_extent, 1));
            bool upright = abs(direction.y) >= abs(direction.x);
            int side = upright ? (y < 0 ? 0 : 2) : (x < 0 ? 3 : 1);
            float outward = max(abs(direction.x), abs(direction.y));
            float along = side == 0 ? direction.x : side == 1 ? direction.y
                        : side == 2 ? -direction.x : -direction.y;
            float first = side == 0 ? ring[0] : side == 1 ? ring[2] : side == 2 ? ring[4]
                    : ring[6];
            float mid = side == 0 ? ring[1] : side == 1 ? ring[3] : side == 2 ? ring[5] : ring[7];
            float last = side == 0 ? ring[2] : side == 1 ? ring[4] : side == 2 ? ring[6] : ring[0];
            float ends = along < 0.0 ? mid - first : last - mid;
            worst = max(worst, abs(centre + outward * (mid - centre) + along * ends - truth));
            ivec2 reach = middle + ivec2(side == 1 ? 1 : side == 3 ? -1 : 0,
                                         side == 2 ? 1 : side == 0 ? -1 : 0) * half_side;
            bool at_rim = upright ? reach.y == 0 || reach.y == TILE
                    : reach.x == 0 || reach.x == TILE;
            if (at_rim && outward < 1.0) {
                // One triangle from the middle to both ends of the side.
                ivec2 parts = upright ? ivec2(low.x, high.x) : ivec2(low.y, high.y);
                float before = float(side == 0 || side == 1 ? parts.x : parts.y);
                float from = float(side == 0 ? x : side == 1 ? y : side == 2 ? -x : -y);
                float share = (from + outward * before) / float(parts.x + parts.y);
                float joined = centre + outward * (first - centre) + share * (last - first);
                worst = max(worst, abs(joined - truth));
            }
        }
    }
    return worst;
}

float error_of_level(int level, ivec2 cells) {
    int half_side = 1 << level;
    float worst = 0.0;
    for (int y = half_side; y - half_side < cells.y; y += 2 * half_side) {
        for (int x = half_side; x - half_side < cells.x; x += 2 * half_side) {
            worst = max(worst, error_of_block(ivec2(x, y), half_side, cells));
        }
    }
    return worst;
}

// Of the last level: two triangles, parted so that four tiles in a square make a fan as well.
float error_of_two(bool turned, ivec2 cells) {
    float corner = node(ivec2(0)), east = node(ivec2(TILE, 0));
    float north = node(ivec2(0, TILE)), far = node(ivec2(TILE));
    float worst = 0.0;
    for (int y = 0; y <= cells.y; y++) {
        for (int x = 0; x <= cells.x; x++) {
            // anchor: two
            vec2 s = vec2(x, y) / vec2(cells);
            float plane = s.x >= s.y ? corner + s.x * (east - corner) + s.y * (far - east)
                                 : corner + s.y * (north - corner) + s.x * (far - north);
            float other = s.x + s.y <= 1.0
                ? corner + s.x * (east - corner) + s.y * (north - corner)
                : far + (1.0 - s.x) * (north - far) + (1.0 - s.y) * (east - far);
            worst = max(worst, abs((turned ? other : plane) - node(ivec2(x, y))));
            // end: two
        }
    }
    return worst;
}

void kernel(ivec2 texel, out vec4 spans, out vec4 errors) {
    ivec2 texels = textureSize(height, 0);
    ivec2 corner = texel * TILE;
    ivec2 cells = clamp(cells_of_tiles(texels) - corner, ivec2(1), ivec2(TILE));
    bool broken = false;
    for (int y = 0; y <= TILE; y++) {
        for (int x = 0; x <= TILE; x++) {
            float found = height_of_node(height, corner + ivec2(x, y));
            bool hole = isnan(found) || isinf(found);
            broken = broken || hole;
            // The height that a vertex of view/land has there.
            found = hole ? 0.0 : found;
            spans.xy = x + y == 0 ? vec2(found) : vec2(min(spans.x, found), max(spans.y, found));
            nodes[y * ROW + x] = found;
        }
    }
    spans.zw = share_of_node(vec2(corner + TILE), texels);
    // anchor: levels
    errors.x = error_of_level(1, cells);
    errors.y = max(errors.x, error_of_level(2, cells));
    errors.z = max(errors.y, error_of_level(3, cells));
    errors.w = max(errors.z, error_of_two(((texel.x + texel.y) & 1) == 1, cells));
    // end: levels
    if (broken) errors = vec4(NEVER);
}
