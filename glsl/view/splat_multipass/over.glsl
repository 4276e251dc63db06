// view/splat_multipass/over.glsl -- the terrain in another texture, blended over the first.
//
//   gives    frame, linear light, over an earlier draw of the same mesh
//   needs    maths/drape.glsl, maths/number.glsl, texturing/splat_weights.glsl,
//            view/splat/surface.glsl, view/surface.glsl, view/vertices.glsl; a height 0..1,
//            weights as of texturing/alpha_map, a tile; a light if there is one, and for tiles of
//            the mesh what view/geomipmap/errors gives
//   units    metres; colours linear; the tile is `repeats` times side by side from west to
//            east
//   source   Belaiche 2010, section 2.6, whose blender does
//            result = alpha texture + (1 - alpha) previous                              (1)
//   tested   tests/glsl/test_splat_view.py: four layers give the picture of view/splat
//
// The thesis takes alpha from the layer's alpha map as it is. By (1), whatever is drawn later
// then hides part of all before it, also of what the map gave to those: of weights 1/2 and 1/2,
// the first layer keeps (1 - 1/2) 1/2 where it is drawn with its own, and a third would take
// from both. So the map's numbers are weights in one picture only if the last layer's is its
// weight and each earlier one has more. What the map must hold for (1) to give the weights w is
//            alpha_k = w_k / (w_1 + ... + w_k),                                         (2)
// the layer's share of what has been drawn so far, and 1 for the first. That is what `shares`
// does; "as in the map" is the thesis's text done to the letter.
//
// Light and air belong to each draw, since (1) is a mean, and the mean of colours in one light
// is the mean colour in that light. Equal depth: it draws where the first layer is seen. Where two
// parts of the terrain tie in depth, both draw, and the layer is blended twice: at a crest, where
// the slope beyond begins at the depth of the one in front. There alone the picture differs from
// that of view/splat in its canonical form by more than 2 of 255; the fast variant of view/splat
// adds what it differs by itself.
//
// How much: twice alpha leaves (1 - alpha)^2 of what was there, so the first k layers keep c^2
// together in place of their weight c = w_1 + ... + w_k. c - c^2 has one maximum, 1/4: at most a
// quarter of the mixture passes to other layers, whatever the weights. Weights and light that
// change within a pixel are not the same on both slopes, which comes on top.
// How often: d pixels from the crest's edge the two slopes differ in depth by d |g - g'|, g and g'
// their changes of depth a pixel; they tie up to d = 2^-24 / |g - g'|, a step of the depth buffer.
// So it grows with the length of all crests in the picture and with their distance, and has no
// fixed limit: 0.3 of 10,000 pixels of mountains, 5 of white noise, one peak a texel.
#include "maths/drape.glsl"
#include "maths/number.glsl"
#include "texturing/splat_weights.glsl"
#include "view/splat/surface.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f", blend = "alpha", depth = "equal")

#include "view/parameters/mesh.glsl"
uniform sampler2D weights;  //! input("linear", "mipmap")
uniform sampler2D colour;   //! input("linear", "repeat", "mipmap")
uniform sampler2D light;    //! input("linear", "mipmap", "white")

uniform float repeats = 48.0;         //! slider(1, 512) step(1) group("Layers")
                                      //! How often the tile repeats from west to east
uniform int layer = 1;                //! slider(1, 3) group("Layers")
                                      //! Which channel of the weights is its own, from 0
uniform int alphas = 0;               //! menu("shares", "as in the map") group("Layers")
                                      //! Its share of what has been drawn so far, or its weight as
                                      //! if it were that
#include "view/parameters/haze.glsl"

vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark) {
    return vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
}

vec4 fragment(vec3 position, float mark) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, share * vec2(1.0, extent.y / extent.x) * repeats).rgb;
    vec4 weight = weights_seen(weights, share);
    float own = layer == 1 ? weight.y : layer == 2 ? weight.z : weight.w;
    float alpha = alphas == 1 ? own : alpha_of_layer(weight, layer);
    vec3 seen = surface_seen(shown, light, position, mark, earth, horizon, haze);
    // The cut earth is no mixture: it is drawn with the first layer, and hides no surface that
    // ties with it at the border. Nor is what is not a number.
    if (mark > 0.0) alpha = 0.0;
    if (!is_number(alpha) || seen == NOT_A_NUMBER) alpha = 1.0;
    return vec4(seen, alpha);
}
