// lighting/daylight/cover.glsl -- how much of the sky clouds hide: set once, for light and clouds.
//
//   gives    cover: 0 clear, 1 overcast
//   needs    nothing
//   units    share of the sky
//   source   Kasten and Czeplak 1980, as in sky/clouds.glsl: the cover that observers report
//   tested   tests/glsl/test_daylight.py: the light is that of the cover
#pragma kernel(output = "cover:r32f")

uniform float clouds = 0.0;        //! slider(0, 1) step(0.01)
                                   //! Cover of cloud: dims the sun, whitens the sky

float kernel(ivec2 texel) {
    return clouds;
}
