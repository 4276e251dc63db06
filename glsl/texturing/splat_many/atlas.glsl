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

vec4 kernel(ivec2 texel) {
    int cell = max(size.x / 4, 1);
    ivec2 which = texel / cell;
    vec2 place = (vec2(texel - which * cell) + 0.5) / float(cell);
    int number = 4 * which.y + which.x;
    // A whole level: the tile's texels are as large as the cell's.
    float side = float(cell);
    switch (number) {
    case 0: return vec4(textureLod(material_1, place,
                                   floor(max(log2(float(textureSize(material_1, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 1: return vec4(textureLod(material_2, place,
                                   floor(max(log2(float(textureSize(material_2, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 2: return vec4(textureLod(material_3, place,
                                   floor(max(log2(float(textureSize(material_3, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 3: return vec4(textureLod(material_4, place,
                                   floor(max(log2(float(textureSize(material_4, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 4: return vec4(textureLod(material_5, place,
                                   floor(max(log2(float(textureSize(material_5, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 5: return vec4(textureLod(material_6, place,
                                   floor(max(log2(float(textureSize(material_6, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 6: return vec4(textureLod(material_7, place,
                                   floor(max(log2(float(textureSize(material_7, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 7: return vec4(textureLod(material_8, place,
                                   floor(max(log2(float(textureSize(material_8, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 8: return vec4(textureLod(material_9, place,
                                   floor(max(log2(float(textureSize(material_9, 0).x) / side), 0.0)
                                         + 0.5)).rgb, 1.0);
    case 9: return vec4(textureLod(material_10, place,
                                   floor(max(log2(float(textureSize(material_10, 0).x) / side),
                                             0.0) + 0.5)).rgb, 1.0);
    case 10: return vec4(textureLod(material_11, place,
                                    floor(max(log2(float(textureSize(material_11, 0).x) / side),
                                              0.0) + 0.5)).rgb, 1.0);
    case 11: return vec4(textureLod(material_12, place,
                                    floor(max(log2(float(textureSize(material_12, 0).x) / side),
                                              0.0) + 0.5)).rgb, 1.0);
    case 12: return vec4(textureLod(material_13, place,
                                    floor(max(log2(float(textureSize(material_13, 0).x) / side),
                                              0.0) + 0.5)).rgb, 1.0);
    case 13: return vec4(textureLod(material_14, place,
                                    floor(max(log2(float(textureSize(material_14, 0).x) / side),
                                              0.0) + 0.5)).rgb, 1.0);
    case 14: return vec4(textureLod(material_15, place,
                                    floor(max(log2(float(textureSize(material_15, 0).x) / side),
                                              0.0) + 0.5)).rgb, 1.0);
    }
    return vec4(textureLod(material_16, place,
                           floor(max(log2(float(textureSize(material_16, 0).x) / side), 0.0)
                                 + 0.5)).rgb, 1.0);
}
