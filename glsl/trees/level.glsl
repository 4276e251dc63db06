// trees/level.glsl -- how many trees are drawn at a distance, and how large each then is.
//
//   gives    JITTER, GROWTH, end_of_table, kept_share, drawn_share, drawn_part, growth_of_kept,
//            shrunk, covering_share
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
// Each tree has a rank, 0..1, of its own, and is whole where its rank is below the share that is
// kept there. From there it shrinks to nothing, at a rank a quarter above that share, so none ever
// pops; none is smaller than it is where all are kept, but near the end of all.
#ifndef TREES_LEVEL
#define TREES_LEVEL

const float JITTER = 0.8;   // of a cell's side: where in its middle its tree may stand
const float GROWTH = -0.4;  // the power of the share that is kept by which a tree grows
const float LONGER = 1.25;  // a tree is drawn up to a rank of so many times the share
const float FADE = 0.2;     // the same from there inwards: 1 - 1 / LONGER

// How far away single trees end: at `reach`, or where the table of cells ends before.
float end_of_table(float reach, float cell, ivec2 cells) {
    return min(reach, 0.5 * cell * float(min(cells.x, cells.y) - 2));
}

// All up to `whole`; farther away, as many a square metre as there are pixels for one; none from
// `reach` on.
float kept_share(float eye_distance, float whole, float reach) {
    float near = min(whole / max(eye_distance, 1e-3), 1.0);
    return eye_distance < reach ? near * near : 0.0;
}

// A tree's growth. Over the last tenth of `reach` all of them shrink to nothing: were fewer kept
// there instead, the last would go within a metre of the eye's way, and pop.
// anchor: growth
float growth_of_kept(float eye_distance, float whole, float reach) {
    float left = clamp((reach - eye_distance) / max(0.1 * reach, 1e-3), 0.0, 1.0);
    return left * pow(max(eye_distance / max(whole, 1e-3), 1.0), -2.0 * GROWTH);
}
// end: growth

// Those that are drawn, whole or shrunk.
float drawn_share(float kept) { return min(LONGER * kept, 1.0); }

// How near to where it ends the last of them is; FADE less than 1 where all are whole.
float drawn_part(float kept) { return min(1.0, (1.0 - FADE) / max(kept, 1e-6)); }

// `key`: the rank over the share that is drawn; `part`: drawn_part; `limit`: the key of the first
// tree that a list has no room for, 1 where it has room for all. The less room, the wider the
// fade before it, so that neither the eye's way nor a list that fills lets one pop.
float shrunk(float key, float part, float limit) {
    float by_distance = clamp((1.0 - key / limit * part) / FADE, 0.0, 1.0);
    float by_room = clamp((1.0 - key / limit) / clamp(1.0 - limit, 1e-6, FADE), 0.0, 1.0);
    return min(by_distance, by_room);
}

// What those that are drawn cover, over what all would, before they grow: by their number and the
// mean of shrunk^2. Both fades at once, where there is room for nearly all, are the wider of them.
float covering_share(float kept, float limit) {
    float part = drawn_part(kept);
    float rest = (1.0 - part) / FADE;
    float by_distance = (1.0 - FADE + FADE / 3.0 * (1.0 - rest * rest * rest)) / part;
    float by_room = 1.0 - 2.0 / 3.0 * min(1.0 - limit, FADE);
    return limit * drawn_share(kept) * min(by_distance, by_room);
}
#endif
