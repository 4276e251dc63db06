// texturing/waters.glsl -- rivers and lakes laid over a colour, and wet ground darkened.
//
//   gives    colour
//   needs    maths/land.glsl
//   units    linear colours; covers and wetness 0..1; depths in metres
//   source   light lost in water: Beer and Lambert; wet ground is darker: Lekner and Dorf 1988,
//            "Why some things are darker when wet", Applied Optics 27
//   tested   tests/glsl/test_rivers.py, by colours of known covers
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;   //! input
uniform sampler2D river;    //! input("zero")
uniform sampler2D lake;     //! input("zero")
uniform sampler2D wetness;  //! input("zero")
uniform vec3 shallow = vec3(0.06, 0.13, 0.14);  //! colour Of rivers, and of lakes by the shore
uniform vec3 deep = vec3(0.012, 0.045, 0.07);   //! colour Of deep lakes
uniform float clarity = 6.0;     //! slider(0.1, 50) step(0.1) unit("m") Depth at which a lake has
                                 //! two thirds of its deep colour
uniform float shore = 1.0;       //! slider(0.1, 20) step(0.1) unit("m") Depth at which no ground
                                 //! shows
uniform float darkening = 0.35;  //! slider(0, 1) step(0.01) Of wet ground

// A number of a field of any size.
float here(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    vec2 place = place_on(grid, texel, size);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, grid - 1);
    vec4 corner = vec4(texelFetch(field, low, 0).r, texelFetch(field, ivec2(high.x, low.y), 0).r,
                       texelFetch(field, ivec2(low.x, high.y), 0).r, texelFetch(field, high, 0).r);
    return bilinear(corner, place - vec2(low));
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(colour, 0);
    vec4 ground = texelFetch(colour, ivec2(place_on(grid, texel, size) + 0.5), 0);
    float depth = here(lake, texel);
    vec3 water = mix(deep, shallow, exp(-depth / clarity));
    float cover = max(here(river, texel), clamp(depth / shore, 0.0, 1.0));
    vec3 dark = ground.rgb * (1.0 - darkening * here(wetness, texel));
    return vec4(mix(dark, water, cover), ground.a);
}
