// maths/drape.glsl -- the texture coordinate of a place on the terrain.
//
//   gives    drape_uv
//   needs    nothing: pure functions, no uniforms, no textures
//   units    shares 0..1 of the terrain's side, east and north; texture coordinates 0..1
//   source   derived here
//   tested   tests/glsl/test_view.py: the terrain's corners are the corner texels' middles
//
// The first and the last texel of a row are on the terrain's edges, but a texture's 0 and 1
// lie half a texel outside their middles. Without this, textures of two sizes drift apart.
#ifndef MATHS_DRAPE
#define MATHS_DRAPE

vec2 drape_uv(vec2 share, ivec2 texels) {
    return (share * vec2(texels - 1) + 0.5) / vec2(texels);
}
#endif
