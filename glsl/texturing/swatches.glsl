// texturing/swatches.glsl -- images side by side in one row, to be looked at.
//
//   gives    colour, linear light
//   needs    images of any size; what is not wired is white
//   units    none: each image fills a square, `gap` texels from the next
//   source   the layout of Belaiche 2010, figure 2.3
//   tested   tests/glsl/test_texturing_base.py: each image's colour is in its place
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D first;   //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D second;  //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D third;   //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D fourth;  //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D fifth;   //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D sixth;   //! input("linear", "repeat", "mipmap", "white")

uniform int begin = 0;            //! slider(0, 5) How many images are passed over
uniform int count = 3;            //! slider(1, 6) How many are shown
uniform int gap = 4;              //! slider(0, 64) Texels between them
uniform float tiles = 1.0;        //! slider(1, 8) step(0.5)
                                  //! How often each repeats in its square: seams would show
uniform vec3 paper = vec3(0.8);   //! colour What is between them

vec3 shown(sampler2D image, vec2 place, float texels) {
    float level = max(log2(float(textureSize(image, 0).x) * tiles / texels), 0.0);
    return textureLod(image, place * tiles, level).rgb;
}

vec4 kernel(ivec2 texel) {
    float side = min(float(size.x - gap * (count - 1)) / float(count), float(size.y));
    float pitch = side + float(gap);
    // The row is in the middle.
    vec2 place = vec2(texel) + 0.5 - 0.5 * (vec2(size)
                                            - vec2(pitch * float(count) - float(gap), side));
    float column = floor(place.x / pitch);
    vec2 inside = vec2(place.x - column * pitch, place.y) / side;
    bool outside = column < 0.0 || column >= float(count) || any(lessThan(inside, vec2(0.0)))
            || any(greaterThanEqual(inside, vec2(1.0)));
    if (outside) return vec4(paper, 1.0);
    int which = int(column) + begin;
    vec3 colour = paper;
    if (which == 0) colour = shown(first, inside, side);
    if (which == 1) colour = shown(second, inside, side);
    if (which == 2) colour = shown(third, inside, side);
    if (which == 3) colour = shown(fourth, inside, side);
    if (which == 4) colour = shown(fifth, inside, side);
    if (which == 5) colour = shown(sixth, inside, side);
    return vec4(colour, 1.0);
}
