// texturing/splat_many/atlas.glsl -- sixteen tiles in one texture, four by four.
//
//   gives    atlas, linear light
//   needs    up to sixteen tiles that repeat, each of any size; the others are black
//   units    a cell is a quarter of the atlas; the first is in the south-west, the fourth east of
//            it
//   source   none: OpenGL promises a kernel sixteen textures and no arrays of them here
//   tested   tests/glsl/test_splat_many.py, against the tiles
//
// Cells are powers of two on a side, so that no texel of a smaller mipmap mixes two of them,
// down to the one where a cell is one texel.
#pragma kernel(output = "atlas:rgba16f", accepts = "2**n")

uniform sampler2D material_1;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_2;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_3;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_4;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_5;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_6;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_7;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_8;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_9;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_10;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_11;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_12;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_13;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_14;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_15;  //! input("linear", "repeat", "mipmap", "black")
uniform sampler2D material_16;  //! input("linear", "repeat", "mipmap", "black")

// A tile in a cell `side` texels wide: by a whole level, whose texels are as large as the cell's.
vec4 of_tile(sampler2D tile, vec2 place, float side) {
    float level = max(log2(float(textureSize(tile, 0).x) / side), 0.0);
    return vec4(textureLod(tile, place, floor(level + 0.5)).rgb, 1.0);
}

vec4 kernel(ivec2 texel) {
    int cell = max(size.x / 4, 1);
    ivec2 which = texel / cell;
    vec2 place = (vec2(texel - which * cell) + 0.5) / float(cell);
    int number = 4 * which.y + which.x;
    float side = float(cell);
    switch (number) {
    case 0: return of_tile(material_1, place, side);
    case 1: return of_tile(material_2, place, side);
    case 2: return of_tile(material_3, place, side);
    case 3: return of_tile(material_4, place, side);
    case 4: return of_tile(material_5, place, side);
    case 5: return of_tile(material_6, place, side);
    case 6: return of_tile(material_7, place, side);
    case 7: return of_tile(material_8, place, side);
    case 8: return of_tile(material_9, place, side);
    case 9: return of_tile(material_10, place, side);
    case 10: return of_tile(material_11, place, side);
    case 11: return of_tile(material_12, place, side);
    case 12: return of_tile(material_13, place, side);
    case 13: return of_tile(material_14, place, side);
    case 14: return of_tile(material_15, place, side);
    }
    return of_tile(material_16, place, side);
}
