// trees/level.glsl -- how many trees are drawn at a distance, and how large each then is.
//
//   gives    JITTER, GROWTH, end_of_table, kept_share, growth_of_kept, shrunk
//   needs    nothing: pure functions, no uniforms, no textures
//   units    metres; shares 0..1; growth and shrinking are factors of a tree's height
//   source   Cook, Halstead, Planck and Ryu 2007, "Stochastic Simplification of Aggregate Detail"
//            (SIGGRAPH): what is kept grows as what is left out covered
//   tested   tests/glsl/test_trees.py
//
// By areas trees would grow by kept^-0.5. With kept^-0.4 they stay smaller against the sky; with
// kept^-0.3 a stand has gaps, where one sees its dark side: 7 hundredths darker (the test says 5).
// What then still lacks is in the ground's colour: trees/wood.
//
// Each tree has a rank, 0..1, of its own, and is drawn where its rank is below the share that is
// kept there. Over the last fifth before that a tree shrinks to nothing, so none ever pops.
#ifndef TREES_LEVEL
#define TREES_LEVEL

const float JITTER = 0.8;   // of a cell's side: where in its middle its tree may stand
const float GROWTH = -0.4;  // the power of the share that is kept by which a tree grows

// How far away single trees end: at `reach`, or where the table of cells ends before.
float end_of_table(float reach, float cell, ivec2 cells) {
    return min(reach, 0.5 * cell * float(min(cells.x, cells.y) - 2));
}

// All up to `whole`; farther away, as many a square metre as there are pixels for one; over the
// last tenth of `reach` fewer and fewer, down to none.
float kept_share(float away, float whole, float reach) {
    float near = min(whole / max(away, 1e-3), 1.0);
    return near * near * (1.0 - smoothstep(0.9 * reach, reach, away));
}

// A tree's growth where only distance thins the others, not the end of what is drawn.
float growth_of_kept(float away, float whole) {
    return pow(max(away / max(whole, 1e-3), 1.0), -2.0 * GROWTH);
}

// `key`: the rank over the share that is kept. Whole below 0.8, nothing from 1 on.
float shrunk(float key) {
    return clamp((1.0 - key) * 5.0, 0.0, 1.0);
}
#endif
