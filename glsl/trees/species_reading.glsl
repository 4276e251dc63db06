// trees/species_reading.glsl -- the shares of species at a place of the map of trees/species.
//
//   gives    species_at
//   needs    nothing: the map as an argument; four texels at once, which on software renderers
//            take less time than the loop of terrain/maps.glsl
//   units    shares 0..1; places as shares of the terrain's sides
//   source   interpolation
//   tested   tests/glsl/test_trees_species.py
#ifndef TREES_SPECIES_READING
#define TREES_SPECIES_READING

vec4 species_at(sampler2D species, vec2 share) {
    ivec2 last = textureSize(species, 0) - 1;
    vec2 at = clamp(share, 0.0, 1.0) * vec2(last);
    ivec2 low = ivec2(at);
    ivec2 high = min(low + 1, last);
    vec2 part = at - vec2(low);
    vec4 south = mix(texelFetch(species, low, 0),
                     texelFetch(species, ivec2(high.x, low.y), 0), part.x);
    vec4 north = mix(texelFetch(species, ivec2(low.x, high.y), 0),
                     texelFetch(species, high, 0), part.x);
    return mix(south, north, part.y);
}
#endif
