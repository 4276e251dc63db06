// simulation/gray_scott/step.glsl -- some steps of a reaction, U + 2V to 3V, and of diffusion.
//
//   gives    amounts: red U, green V
//   needs    nothing
//   units    concentrations without unit; a step is 1, a cell is 1 wide
//   source   Pearson 1993, "Complex Patterns in a Simple System", Science 261, eq. 1:
//                dU/dt = Du lap U - U V^2 + F (1 - U)
//                dV/dt = Dv lap V + U V^2 - (F + k) V
//            by forward Euler, with Du = 2e-5 and Dv = Du / 2 over cells 2.5 / 256 wide
//   tested   tests/glsl/test_gray_scott.py, against one step in float64, and by what is kept
//
// Both sides of the field are neighbours. Explicit diffusion is stable while 4 Du < 1.
#pragma kernel(output = "amounts:rg32f", repeat = "steps")

uniform int steps = 12;        //! slider(1, 64) Steps a frame
uniform float feed = 0.037;    //! slider(0, 0.1) step(0.001) F: how fast U is fed, all drained
uniform float kill = 0.06;     //! slider(0, 0.1) step(0.001) k: how fast V is taken away besides
uniform float spread = 0.209;  //! slider(0, 0.24) step(0.001) Du: how U spreads, V half as fast

vec2 kernel(ivec2 texel) {
    ivec2 west = ivec2((texel.x + size.x - 1) % size.x, texel.y);
    ivec2 east = ivec2((texel.x + 1) % size.x, texel.y);
    ivec2 south = ivec2(texel.x, (texel.y + size.y - 1) % size.y);
    ivec2 north = ivec2(texel.x, (texel.y + 1) % size.y);
    vec2 here = previous(texel);
    vec2 bend = previous(west) + previous(east) + previous(south) + previous(north) - 4.0 * here;
    float reaction = here.x * here.y * here.y;
    return here + vec2(1.0, 0.5) * spread * bend
         + vec2(feed * (1.0 - here.x) - reaction, reaction - (feed + kill) * here.y);
}
