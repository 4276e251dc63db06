// generation/circles/discs.glsl -- random discs, one a texel: where, how wide and how high.
//
//   gives    disc: middle in red and green, radius in blue, height of the dome in alpha
//   needs    generation/circles/dome.glsl, noise/hash.glsl
//   units    see generation/circles/dome.glsl; height without unit
//   source   Belaiche 2010, section 1.3.7
//   tested   tests/glsl/test_marks.py, against a twin in NumPy
//
// The thesis says how wide discs are, at random, but not how high: all alike, or the wider
// the higher, so that none is steeper than another.
#include "generation/circles/dome.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "disc:rgba32f")

uniform uint seed = 7u;         //! slider(0, 9999) Which terrain
uniform float smallest = 0.02;  //! slider(0, 1) step(0.005) Smallest radius, as a share of the
                                //! terrain's shorter side
uniform float largest = 0.2;    //! slider(0, 1) step(0.005) Largest radius, as a share of the
                                //! terrain's shorter side
uniform float rise = 0.1;       //! log_slider(0.001, 1) Height of the widest dome
uniform int rises = 0;          //! menu("with the radius", "alike") Heights of the others

const uint SALT = 0x610a4b03u;  // CRC-32 of "generation/circles"

vec4 kernel(ivec2 texel) {
    uvec3 bits = hash3(uvec3(uint(texel.x), 0u, seed + SALT));
    vec2 share = vec2(unit_from_bits(bits.x), unit_from_bits(bits.y));
    vec2 middle = share * extent / shorter_side(extent);
    float low = min(smallest, largest);
    float high = max(smallest, largest);
    float radius = low + (high - low) * unit_from_bits(bits.z);
    float height = rises == 1 || high <= 0.0 ? rise : rise * radius / high;
    return vec4(middle, radius, height);
}
