// lighting/horizon_sun/between.glsl -- the horizons in the two directions that the sun is between.
//
//   gives    between: the upright one and the slanting one
//   needs    the angles of horizon_sun/angles; which they are, of horizon_sun/stand
//   units    shares of 90 degrees, in 16 bits
//   source   Max 1988, "Horizon Mapping: Shadows for Bump-Mapped Surfaces"
//   tested   tests/glsl/test_analytic.py, against float64
//
// A sun that moves stays between the same two for an eighth of the way round, and without a GPU
// this does not run again until it leaves them: what follows reads 4 bytes a texel and not 16.
#pragma kernel(output = "between:rg16")

uniform sampler2D upright;               //! input
uniform sampler2D slanting;              //! input
uniform sampler2D stand;                 //! input

float one_of(vec4 four, float which) {
    return dot(four, vec4(equal(vec4(0.0, 1.0, 2.0, 3.0), vec4(which))));
}

vec2 kernel(ivec2 texel) {
    vec2 which = texelFetch(stand, ivec2(0), 0).xy;
    return vec2(one_of(texelFetch(upright, texel, 0), which.x),
                one_of(texelFetch(slanting, texel, 0), which.y));
}
