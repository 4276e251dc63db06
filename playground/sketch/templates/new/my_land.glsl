// my_land.glsl -- a terrain of your own: layers of smooth random heights, with ridges.
//
// A kernel is one function that computes one texel of a texture. The next lines make it
// one: what it includes, what it gives (here a texture "height" of one float a texel),
// and its parameters. Save this file while the window is open, and the terrain changes.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

// Each uniform with a //! comment is a parameter: a widget with its range, then its
// tooltip. The panel shows it, and so does  --set height.frequency=8.
uniform float frequency = 5.0;  //! log_slider(1, 64) Hills from west to east
uniform int   layers    = 8;    //! slider(1, 12)     How many layers, each twice as fine
uniform float roughness = 0.42; //! slider(0, 1) step(0.01) Strength of each layer relative to the one before
uniform float ridges    = 0.6;  //! slider(0, 1) step(0.01) 0 gives round hills, 1 gives sharp crests
uniform uint  seed      = 7u;   //! slider(0, 9999)   Which terrain

// Random heights on a lattice, smoothly joined: from 0 to 1.
float smooth_noise(vec2 place, uint layer) {
    ivec2 cell = ivec2(floor(place));
    vec2 share = fract(place);
    // Flat at both ends, so that neighbouring cells meet without a crease.
    share = share * share * share * (share * (share * 6.0 - 15.0) + 10.0);
    float south = mix(random(cell, layer), random(cell + ivec2(1, 0), layer), share.x);
    float north = mix(random(cell + ivec2(0, 1), layer), random(cell + ivec2(1, 1), layer), share.x);
    return mix(south, north, share.y);
}

// Texel (0, 0) is the south-west corner. `size` is given: the texture's width and height.
// Heights are 0 to 1; the sketch's `relief` says how many metres that is.
float kernel(ivec2 texel) {
    vec2 place = vec2(texel) / float(size.x - 1) * frequency;
    float total = 0.0;
    float most = 0.0;
    float strength = 1.0;
    for (int layer = 0; layer < layers; layer++) {
        float hills = smooth_noise(place, seed + uint(layer));
        float crests = 1.0 - abs(2.0 * hills - 1.0);
        total += strength * mix(hills, crests * crests, ridges);
        most += strength;
        strength *= roughness;
        place *= 2.0;
        // Try it: rotate each layer against the one before.
        // place = mat2(0.8, 0.6, -0.6, 0.8) * place;
    }
    return total / most;
}
