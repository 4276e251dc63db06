// generation/endless/shape.glsl -- the shape of an endless terrain: hills of low frequency.
//
//   gives    shape, 0..1
//   needs    terrain/parts.glsl, noise/gradient.glsl
//   units    heights without unit; widths in texels
//   source   Belaiche 2010, section 5.6: a layer of low frequency is the terrain's shape
//   tested   tests/glsl/test_endless.py, against a twin in float64 with Python's whole numbers
//
// Gradient noise where the thesis has values at nodes: its hills are not in rows.
#include "noise/gradient.glsl"
#include "terrain/parts.glsl"
#pragma kernel(output = "shape:r32f", warns = "\
    hills < 2 ** layers: \
    the last layers all have hills of two texels (raise hills or lower layers)")

uniform ivec2 part = ivec2(0);     //! parts("east", "north") Which part of the terrain, counted
                                   //! east and north
uniform int apron = 0;             //! slider(0, 1024) unit("texels") Of the neighbours, so much
                                   //! around the part
uniform int hills = 256;           //! log_slider(2, 4096) unit("texels") Width of the widest hills
uniform int layers = 3;            //! slider(1, 8) Layers of hills, each half as wide as the one
                                   //! before
uniform float persistence = 0.4;   //! slider(0, 1) step(0.01) Height of each layer over the one
                                   //! before
uniform uint seed = 7u;            //! slider(0, 9999) Which terrain

const uint SALT = 0xa677a9a0u;  // CRC-32 of "generation/endless/shape"

float hills_at(ivec2 node, int wide, uint which) {
    vec2 share;
    ivec2 cell = cell_of(node, wide, share);
    return perlin_in_cell(cell, share, which).x;
}

float kernel(ivec2 texel) {
    ivec2 node = node_of(texel, part, apron, size);
    float total = 0.0;
    float strengths = 0.0;
    float strength = 1.0;
    for (int k = 0; k < layers; k++) {
        // Off the lattice of the layer before by an uneven part of a cell: points of the two never
        // meet.
        int wide = max(hills >> k, 2);
        ivec2 moved = node + k * ivec2((wide * 5) >> 3, (wide * 3) >> 3);
        total += strength * hills_at(moved, wide, lattice_seed(seed + SALT, k));
        strengths += strength;
        strength *= persistence;
    }
    // A sum of layers seldom comes near its bounds: with the middle two thirds all heights are
    // used.
    return clamp(0.5 + 0.75 * total / strengths, 0.0, 1.0);
}
