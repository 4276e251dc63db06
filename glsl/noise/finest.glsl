// noise/finest.glsl -- the key of a point of a halved terrain, the same at every size.
//
//   gives    FINEST_SIDE, finest_point
//   needs    nothing: pure functions, no uniforms, no textures
//   units    points in spacings of a lattice; a side is a power of two, up to 32768
//   source   derived here
//   tested   tests/glsl/test_noise.py: the statistics of random numbers;
//            tests/glsl/test_generation.py:
//            a terrain at one size is that at another, read at fewer points
//
// A texel's own number would be a key that changes with the size: texel 64 is in the middle of
// 129 texels and at a quarter of 257, and the same seed would be another terrain. The point's
// place on the finest lattice that there can be is the same at every size. It also tells the
// level of halving at which the point came: a point of a coarse lattice is one of every finer one.
#ifndef NOISE_FINEST
#define NOISE_FINEST

const int FINEST_SIDE = 32768;

// Where a point of a lattice of so many spacings a side lies on the finest lattice.
ivec2 finest_point(ivec2 point, int side) {
    // By a float: both are powers of two, so it is exact, and processors divide integers slowly.
    return point * int(float(FINEST_SIDE) / float(side));
}
#endif
