// erosion/brush/hold.glsl -- what a brush lets happen of a step of erosion, and slumping.
//
//   gives    state: red the bed, green the water on it, blue what the water carries, alpha the
//            rock that has left with the water
//   needs    the state before the step and after it, of the size of this pass
//   units    metres, the load as metres of rock; the brush 0..1
//   source   derived here; the slump: Musgrave, Kolb and Mace 1989, "The Synthesis and Rendering
//            of Eroded Fractal Terrains", SIGGRAPH, section 3.3
//   tested   tests/glsl/test_erosion_brush.py, by what is conserved and by a step in float64
//
// The bed takes the brush's share w of its change, and the water the rest of the rock:
//
//     bed  = before + w (after - before)
//     load = load after + (1 - w) (after - before)
//
// so bed and load together stay what they were, and nothing changes where the brush does not
// reach. There water and load leave, and what leaves is summed in alpha. Between two texels the
// lesser share slides: what one gives the other takes.
#pragma kernel(output = "state:rgba32f")

uniform sampler2D before;  //! input
uniform sampler2D after;   //! input
uniform sampler2D brush;   //! input("white")

uniform float repose = 40.0;  //! angle(1, 89) Angle of repose: what is steeper slumps
uniform float creep = 0.005;  //! slider(0, 0.05) step(0.001)
                              //! The share of a difference that creeps downhill in a step

// Share of what is too steep that slides in a step. From four neighbours it takes, with the most
// creep, 0.4 of the way to them, and wear half of it: so no step digs below the lowest one.
const float SLUMP = 0.05;

// What slides here from the neighbour at an offset: antisymmetric, so that no rock is made.
float slides(ivec2 texel, ivec2 offset, float bed, float share, float maximum) {
    ivec2 there = clamp(texel + offset, ivec2(0), size - 1);
    float rise = texelFetch(before, there, 0).x - bed;
    float over = rise - clamp(rise, -maximum, maximum);
    return min(share, texelFetch(brush, there, 0).r) * (SLUMP * over + creep * rise);
}

vec4 kernel(ivec2 texel) {
    vec4 was = texelFetch(before, texel, 0);
    vec4 now = texelFetch(after, texel, 0);
    float share = clamp(texelFetch(brush, texel, 0).r, 0.0, 1.0);
    vec2 maximum = tan(radians(repose)) * spacing;
    float slid = (slides(texel, ivec2(-1, 0), was.x, share, maximum.x)
                + slides(texel, ivec2(1, 0), was.x, share, maximum.x))
               + (slides(texel, ivec2(0, -1), was.x, share, maximum.y)
                + slides(texel, ivec2(0, 1), was.x, share, maximum.y));
    float change = now.x - was.x;
    float bed = was.x + (share * change + slid);
    // What the bed really takes, after rounding, is what the load loses.
    float load = now.z + (change - ((bed - was.x) - slid));
    if (share > 0.0) return vec4(bed, now.y, load, was.w);
    return vec4(was.x, 0.0, 0.0, was.w + load);
}
