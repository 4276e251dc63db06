// trees/level.glsl -- how many trees are drawn at a distance, and how large each then is.
//
//   gives    kept_share, growth_of_kept, shrunk
//   needs    nothing: pure functions, no uniforms, no textures
//   units    metres; shares 0..1; growth and shrinking are factors of a tree's height
//   source   Cook, Halstead, Planck and Ryu 2007, "Stochastic Simplification of Aggregate Detail"
//            (SIGGRAPH): what is kept grows as what is left out covered. By areas the factor is
//            kept^-0.5; a wood whose crowns hide each other needs less, and -0.3 keeps crowns
//            from being giants. What is then still lacking is in the ground: trees/wood.glsl.
//   tested   tests/glsl/test_trees.py
//
// Each tree has a rank, 0..1, of its own, and is drawn where its rank is below the share that is
// kept there. Over the last fifth before that a tree shrinks to nothing, so none ever pops.
#ifndef TREES_LEVEL
#define TREES_LEVEL

// All up to `whole`; farther away, as many a square metre as there are pixels for one; over the
// last tenth of `reach` fewer and fewer, down to none.
float kept_share(float away, float whole, float reach) {
    float near = min(whole / max(away, 1e-3), 1.0);
    return near * near * (1.0 - smoothstep(0.9 * reach, reach, away));
}

// A tree's growth where only distance thins the others, not the end of what is drawn.
float growth_of_kept(float away, float whole) {
    return pow(max(away / max(whole, 1e-3), 1.0), 0.6);
}

// `key`: the rank over the share that is kept. Whole below 0.8, nothing from 1 on.
float shrunk(float key) {
    return clamp((1.0 - key) * 5.0, 0.0, 1.0);
}
#endif
