// lighting/daylight/dome/joined.glsl -- the halves of the table of the sky side by side.
//
//   gives    dome: as lighting/daylight/dome
//   needs    what lighting/daylight/dome/halves gives
//   units    as lighting/daylight/dome
//   source   none
//   tested   tests/glsl/test_fast_variants.py, against lighting/daylight/dome, bit for bit
#pragma kernel(output = "dome:rgba32f")

uniform sampler2D molecules;  //! input
uniform sampler2D aerosol;    //! input

vec4 kernel(ivec2 texel) {
    int half_width = max(size.x / 2, 1);
    // Of an odd number of columns, the last two have one place.
    int last = textureSize(aerosol, 0).x - 1;
    return texel.x < half_width ? texelFetch(molecules, texel, 0)
            : texelFetch(aerosol, ivec2(min(texel.x - half_width, last), texel.y), 0);
}
