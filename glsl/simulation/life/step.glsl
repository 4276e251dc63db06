// simulation/life/step.glsl -- one frame of the Game of Life, and a fading trail of it.
//
//   gives    life, 1 for a living cell; trail, 1 where there is life, less where there was
//   needs    nothing
//   units    a texel is a cell; both sides of the texture are neighbours
//   source   Gardner 1970, "Mathematical Games", Scientific American 223(4): born of three
//            neighbours, alive with two or three
//   tested   tests/glsl/test_life.py, against the same rule in NumPy, bit by bit
//
// The frame number is the iteration of the loop around it. In a frame between two generations
// only the trail changes, and frame 0 is the first generation itself.
#pragma kernel(output = "life:r8, trail:r8")

uniform sampler2D before;        //! input("zero")
uniform sampler2D trail_before;  //! input("zero")
uniform int every = 4;           //! slider(1, 60) unit("frames") From one generation to the next
uniform float fade = 0.02;       //! slider(0, 1) step(0.004) What the trail loses in a frame

int neighbours(ivec2 texel) {
    int count = 0;
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            ivec2 there = (texel + ivec2(x, y) + size) % size;
            count += int(texelFetch(before, there, 0).r + 0.5);
        }
    }
    return count - int(texelFetch(before, texel, 0).r + 0.5);
}

void kernel(ivec2 texel, out float life, out float trail) {
    life = texelFetch(before, texel, 0).r;
    if (iteration > 0 && iteration % every == 0) {
        int count = neighbours(texel);
        life = count == 3 || (count == 2 && life > 0.5) ? 1.0 : 0.0;
    }
    float faded = iteration > 0 ? texelFetch(trail_before, texel, 0).r - fade : 0.0;
    trail = life > 0.5 ? 1.0 : max(faded, 0.0);
}
