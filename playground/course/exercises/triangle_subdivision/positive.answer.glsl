// generation/triangle_subdivision/raw.glsl -- terrain by dividing triangles in four.
//
//   gives    height, for any terrain of 2^n + 1 texels a side; not normalised
//   needs    noise/finest.glsl, noise/hash.glsl
//   units    heights without unit; lengths in sides of the terrain
//   source   Belaiche 2010, section 1.3.1, after Fournier, Fussell and Carpenter 1982
//            (Communications of the ACM 25, 6)
//   tested   tests/glsl/test_halving.py, against triangles that are divided
//            one by one, in float64 with the same hash
//
// The square is split along its main diagonal, from south-west to north-east. Step 0 sets the
// corners. Each further step halves every edge: a new vertex is the mean of the edge's two
// ends, plus a random number in [-k^r, k^r], where k is the edge's length. Joining the new
// vertices divides each triangle in four, whose edges run east, north, or along the diagonal.
//
// The thesis leaves the unit of k open; here it is the terrain's side, so that k^r falls with
// every step whatever r is, and a terrain looks alike at every size. A diagonal is sqrt(2) times
// as long as its triangle's other edges.
// A vertex knows two others only, so creases stay along the edges, the worst of them on the
// main diagonal: the defect that the thesis describes, kept here.
#include "noise/finest.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f", where = "edges = 2**iteration", \
               repeat = "log2(size.x - 1) + 1", accepts = "2**n + 1", \
               visits = "edges + 1, edges + 1", stride = "(size.x - 1) // edges", \
               between = "triangles")

uniform float r = 1.0;    //! slider(0, 3) step(0.05) How fast the random numbers fall with the
                          //! length of an edge: the more, the smoother
uniform uint seed = 7u;   //! slider(0, 9999) Which terrain
uniform int corners_are = 0;  //! menu("random", "given") Corners at random in [-1, 1], or as given
                              //! below
uniform vec4 corners = vec4(0.0, 0.0, 0.0, 0.0);  //! slider(-1, 1) step(0.01)
    //! parts("SW", "SE", "NW", "NE") Given heights of the corners: south-west, south-east,
    //! north-west, north-east

const uint SALT = 0xa289e770u;  // CRC-32 of "generation/triangle_subdivision"

ivec2 visit(ivec2 cell) {
    // Of the cells of a step, those with two even numbers were vertices before.
    bool known = iteration > 0 && ((cell.x | cell.y) & 1) == 0;
    return known ? ivec2(-1) : cell * ((size.x - 1) >> iteration);
}

float corner(ivec2 texel) {
    if (corners_are == 0) return random_signed(finest_point(texel, size.x - 1), seed + SALT);
    bool east = texel.x > 0;
    bool north = texel.y > 0;
    return north ? (east ? corners.w : corners.z) : (east ? corners.y : corners.x);
}

float kernel(ivec2 texel) {
    int reach = (size.x - 1) >> iteration;
    bool on_lattice = ((texel.x | texel.y) & (reach - 1)) == 0;
    if (iteration == 0) return on_lattice ? corner(texel) : previous(texel);
    // Half the edge, from its middle: on a vertex that was known before it is 0, so that both
    // ends are that vertex, and their mean is its height to the last bit.
    ivec2 half_edge = on_lattice ? texel & reach : ivec2(0);
    float mean = (previous(texel - half_edge) + previous(texel + half_edge)) * 0.5;
    bool is_diagonal = half_edge.x > 0 && half_edge.y > 0;
    // k is 2^(1 - iteration), and sqrt(2) times as much along a diagonal.
    float log_k = (is_diagonal ? 1.5 : 1.0) - float(iteration);
    bool is_new = half_edge.x + half_edge.y > 0;
    ivec2 point = finest_point(texel, size.x - 1);
    return is_new ? mean + random(point, seed + SALT) * exp2(r * log_k) : mean;
}
