// lighting/sky_patches/factor.glsl -- the light of five patches of the sky.
//
//   gives    factor: red, green, blue, as a method's sky factor
//   needs    the patches' shares
//   units    light without unit: 1 under an open sky that is white all over
//   source   Belaiche 2010, section 3.4
//   tested   tests/glsl/test_sky.py, against float64
//
// Each patch has a colour of its own.
#pragma kernel(output = "factor:rgba16f")

uniform sampler2D low;                                //! input
uniform sampler2D high;                               //! input
uniform vec3 overhead = vec3(0.42, 0.62, 1.0);        //! colour group("Sky")
                                                      //! The sky's colour overhead
uniform vec3 north = vec3(0.85, 0.93, 1.0);           //! colour group("Sky") Low in the north
uniform vec3 east = vec3(1.0, 0.97, 0.92);            //! colour group("Sky") Low in the east
uniform vec3 south = vec3(1.0, 0.97, 0.92);           //! colour group("Sky") Low in the south
uniform vec3 west = vec3(0.85, 0.93, 1.0);            //! colour group("Sky") Low in the west

vec4 kernel(ivec2 texel) {
    vec4 share = texelFetch(low, texel, 0);
    vec4 more = texelFetch(high, texel, 0);
    vec3 sum = more.a * overhead + share.x * north + share.y * east + share.z * south
            + share.w * west;
    return vec4(sum * more.rgb, 1.0);
}
