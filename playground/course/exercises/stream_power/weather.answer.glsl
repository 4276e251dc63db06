// erosion/stream_power/link.glsl -- one implicit step of the stream power law, texel by texel.
//
//   gives    link: the new height is red + green times the new height of texel number blue
//   needs    erosion/stream_power/parameters/time.glsl, maths/power.glsl,
//            terrain/heightfield.glsl, water/texels.glsl
//   units    heights without unit; parameters in metres and years
//   source   Braun and Willett 2013, "A very efficient O(n), implicit and parallel method to solve
//            the stream power equation", Geomorphology 180-181, eq. 22:
//                dz/dt = U - K A^m S,   S = (z - z_receiver) / L
//            of uneven rain A is the discharge: Whipple and Tucker 1999, "Dynamics of the
//            stream-power river incision model", J. Geophys. Res. 104(B8), eq. 3
//   tested   tests/glsl/test_stream_power.py, against the slopes of a steady state
//
// With F = K A^m dt / L the new height is (z + U dt + F z_receiver) / (1 + F): a mean, so no step
// is too long. A river begins where it drains so much that slopes alone no longer carry the water:
// that area is added to each texel's, or slopes near ridges would grow as the texels shrink.
#include "erosion/stream_power/parameters/time.glsl"
#include "maths/power.glsl"
#include "terrain/heightfield.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "link:rgba32f")

uniform sampler2D height;    //! input
uniform sampler2D receiver;  //! input
uniform sampler2D area;      //! input
uniform sampler2D uplift;    //! input("white")
uniform sampler2D hardness;  //! input("white")
uniform float rise = 0.5;  //! log_slider(0.01, 20) unit("mm/yr") How fast it rises, times uplift
uniform float erodibility = 5.0;  //! log_slider(0.01, 1000) Metres that a river wears in a million
                                  //! years, at slope 1 and 1 m2
uniform float area_power = 0.5;   //! slider(0.2, 0.8) step(0.01) m: how much more a larger river
                                  //! wears
uniform float head = 30000.0;   //! slider(0, 1000000) step(1000) unit("m2") Where a river begins

const float MOST = 1e9;  // wear in a step, in lengths of the way: beyond it nothing changes

// An input that may have a size of its own, at this level's texel.
float value_here(sampler2D field, ivec2 texel) {
    vec2 last = vec2(textureSize(field, 0) - 1);
    return height_at(field, vec2(texel) * last / vec2(max(size - 1, 1)));
}

vec4 kernel(ivec2 texel) {
    float ground = texelFetch(height, texel, 0).r;
    float to = texelFetch(receiver, texel, 0).r;
    ivec2 there = texel_of(to, size);
    if (there == texel || on_edge(texel, size)) {
        return vec4(ground, 0.0, number_of(texel, size), 0.0);
    }
    float years = 1e6 * age / float(max(steps, 1));
    float lifts = wired_uplift ? max(value_here(uplift, texel), 0.0) : 1.0;
    float hard = wired_hardness ? max(value_here(hardness, texel), 1e-3) : 1.0;
    float drained = clamp(texelFetch(area, texel, 0).r + head, 1e-6, 1e15);
    drained *= 2.0 - float(texel.x) / float(size.x);
    float run = length(vec2(there - texel) * spacing);
    // anchor: implicit
    float wear = 1e-6 * erodibility / hard * years * power(drained, area_power) / run;
    wear = min(wear, MOST);
    float raised = ground + 1e-3 * rise * years * lifts / max(relief, 1e-3);
    return vec4(raised / (1.0 + wear), wear / (1.0 + wear), to, 0.0);
    // end: implicit
}
