// simulation/fluid/pressure.glsl -- the pressure whose gradient takes the divergence away, nearly.
//
//   gives    pressure
//   needs    nothing
//   units    such that its difference over a cell is a velocity
//   source   Jacobi's iteration for lap p = divergence, damped by 2/3 so that the checkerboard
//            decays as well
//   tested   tests/glsl/test_fluid.py: what each wave of the divergence loses in a round
//
// A wave of wave numbers k is left with 1 - 2/3 (1 - (cos kx + cos ky) / 2) of itself in a round:
// short waves go at once, long ones slowly. So each frame begins with the pressure of the last.
#pragma kernel(output = "pressure:r32f", repeat = "rounds")

uniform sampler2D divergence;  //! input
uniform int rounds = 20;       //! slider(1, 200) Rounds a frame

const float DAMPING = 2.0 / 3.0;

float kernel(ivec2 texel) {
    float west = previous(ivec2((texel.x + size.x - 1) % size.x, texel.y));
    float east = previous(ivec2((texel.x + 1) % size.x, texel.y));
    float south = previous(ivec2(texel.x, (texel.y + size.y - 1) % size.y));
    float north = previous(ivec2(texel.x, (texel.y + 1) % size.y));
    float here = previous(texel);
    float solved = 0.25 * (west + east + south + north - texelFetch(divergence, texel, 0).r);
    return here + DAMPING * (solved - here);
}
