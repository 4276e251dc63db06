// generation/by_example/ranks.glsl -- an example's heights as normal numbers, and sorted.
//
//   gives    normal: of each texel the number that has its rank in a normal distribution;
//            sorted: all heights from the lowest on, row by row
//   needs    nothing; the processor makes it (playground/data/by_example.py)
//   units    heights as the example's
//   source   Heitz and Neyret 2018, "High-Performance By-Example Noise using a
//            Histogram-Preserving Blending Operator" (Proc. ACM CGIT 1(2))
//   tested   tests/engine/test_example.py, against SciPy's ranks and normal distribution
#pragma source("ranked_heights", output = "normal:r32f, sorted:r32f")

uniform sampler2D example;     //! input
uniform float widest = 0.0;    //! slider(0, 1) step(0.01) Hills wider than this share of the
                               //! example are left out of it; 0: none are
