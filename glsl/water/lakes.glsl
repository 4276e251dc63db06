// water/lakes.glsl -- standing water: how deep it is.
//
//   gives    lake, 0 where it is dry
//   needs    nothing
//   units    metres
//   source   Planchon and Darboux 2002: what a filled terrain has above the ground
//   tested   tests/glsl/test_rivers.py, against heights
//
// The level of water/fill falls a little along its ways; what is no deeper than that is no lake.
#pragma kernel(output = "lake:r32f")

uniform sampler2D height;        //! input
uniform sampler2D level;         //! input
uniform float shallowest = 0.5;  //! slider(0, 20) step(0.1) unit("m") Less is taken for dry

float kernel(ivec2 texel) {
    float level_here = texelFetch(level, texel, 0).r;
    float depth = relief * (level_here - texelFetch(height, texel, 0).r);
    return depth > shallowest ? depth : 0.0;
}
