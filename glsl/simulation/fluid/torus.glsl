// simulation/fluid/torus.glsl -- read a texture whose sides are neighbours, between texels too.
//
//   gives    on_torus, value_on_torus
//   needs    nothing; the texture comes as an argument
//   units    places in texels, whole numbers at the texels themselves
//   source   none: bilinear interpolation
//   tested   tests/glsl/test_fluid.py, by what is carried around the torus
#ifndef SIMULATION_FLUID_TORUS
#define SIMULATION_FLUID_TORUS

// The remainder of a negative number is undefined in GLSL: as far as 64 fields away none is
// taken.
ivec2 on_torus(ivec2 texel, ivec2 whole) {
    return max(texel + 64 * whole, 0) % whole;
}

// A mean of the four texels around, with weights from 0 to 1: never more than the largest.
vec4 value_on_torus(sampler2D field, vec2 place) {
    ivec2 whole = textureSize(field, 0);
    vec2 corner = floor(place);
    vec2 share = place - corner;
    ivec2 west = on_torus(ivec2(corner), whole);
    ivec2 east = on_torus(ivec2(corner) + 1, whole);
    vec4 south_west = texelFetch(field, west, 0);
    vec4 south_east = texelFetch(field, ivec2(east.x, west.y), 0);
    vec4 north_west = texelFetch(field, ivec2(west.x, east.y), 0);
    vec4 north_east = texelFetch(field, east, 0);
    vec4 south = mix(south_west, south_east, share.x);
    vec4 north = mix(north_west, north_east, share.x);
    return mix(south, north, share.y);
}
#endif
