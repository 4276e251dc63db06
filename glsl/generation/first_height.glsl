// generation/first_height.glsl -- hills from nothing: random numbers, a curve between, octaves.
//
//   gives    height, 0..1 up to a roughness of 0.5; above it, high places may pass 1
//   needs    noise/hash.glsl
//   units    heights without unit
//   source   value noise (Belaiche 2010, section 1.3.9), in as few lines as it takes: the kernel
//            that the first lesson writes
//   tested   tests/glsl/test_noise.py, against interpolation in NumPy
//
// Its terrain is the same at any size. There is no salt in its seed and no shift between its
// octaves: those who write their first kernel have not met what these are for.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f")

uniform float roughness = 0.5;  //! slider(0.2, 0.7) step(0.01) How strong an octave is over the
                                //! one before
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

// anchor: noise
float noise(vec2 place) {
    ivec2 node = ivec2(floor(place));
    vec2 a = place - floor(place);
    a = a * a * (3.0 - 2.0 * a);
    float south = mix(random(node, seed),
                      random(node + ivec2(1, 0), seed), a.x);
    float north = mix(random(node + ivec2(0, 1), seed),
                      random(node + ivec2(1, 1), seed), a.x);
    return mix(south, north, a.y);
}
// end: noise

// anchor: octaves
float kernel(ivec2 texel) {
    vec2 place = 4.0 * vec2(texel) / vec2(size - 1);
    float height = 0.0;
    float weight = 0.5;
    for (int k = 0; k < 5; k++) {
        height += weight * noise(place);
        place = 2.0 * place;
        weight = roughness * weight;
    }
    return height;
}
// end: octaves
