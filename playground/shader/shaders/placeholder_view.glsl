// A copy of a texture.
uniform sampler2D shown;
vec4 kernel(ivec2 texel) { return texelFetch(shown, min(texel, textureSize(shown, 0) - 1), 0); }
