// erosion/terraces.glsl -- mesas, steps, sea cliffs: hard layers are walls, soft ones lie flat.
//
//   gives    height
//   needs    noise/hash.glsl, noise/periodic.glsl, terrain/heightfield.glsl; a height
//   units    metres inside, heights without unit outside
//   source   the idea: Musgrave, in Ebert and others 2003, "Texturing and Modeling", chapter 20
//            (a curve over the heights); the layers of uneven thickness: made here
//   tested   tests/glsl/test_terraces.py, against numpy.interp through the layers' edges
//
// A curve over the heights that goes through the edge of each layer, so that no height moves by
// more than a layer. Within a layer the lower part, a slope of debris, keeps the share `bench` of
// the layer's height, and the rest of it is a wall that takes `wall` of what the height was there.
#include "noise/hash.glsl"
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D height;  //! input

uniform float thickness = 120.0;  //! log_slider(1, 5000) unit("m") How thick a layer is
uniform float uneven = 0.6;       //! slider(0, 1) step(0.01) How much layers differ in thickness
uniform float wall = 0.12;        //! slider(0.01, 1) step(0.01)
                                  //! The share of a layer's height that becomes its wall
uniform float bench = 0.4;        //! slider(0, 1) step(0.01)
                                  //! The share of the layer's height that lies below its wall
uniform vec2 between = vec2(-500.0, 9000.0);  //! slider(-500, 9000) unit("m") parts("from", "to")
                                  //! Only at heights between these, above sea level
uniform float strength = 1.0;     //! slider(0, 1) step(0.01) How far heights move there
uniform float folds = 0.0;        //! slider(0, 1000) step(1) unit("m")
                                  //! How far the layers bend up and down
uniform float fold_width = 3000.0;  //! log_slider(10, 100000) unit("m") From one fold to the next
uniform uint seed = 1u;           //! slider(0, 9999) Which layers

const uint SALT = 0x145eaf8cu;  // CRC-32 of "erosion/terraces"

// The lower edge of a layer.
float edge_of(int layer) {
    float moved = uneven * 0.8 * (random(ivec2(layer, 0), seed + SALT) - 0.5);
    return (float(layer) + moved) * thickness;
}

float stepped(float metres) {
    int layer = int(floor(metres / thickness));
    if (metres < edge_of(layer)) layer--;
    if (metres >= edge_of(layer + 1)) layer++;
    float low = edge_of(layer);
    float high = edge_of(layer + 1);
    float part = (metres - low) / (high - low);
    float foot = 1.0 - wall;
    float share = part < foot ? bench * part / foot : mix(bench, 1.0, (part - foot) / wall);
    return mix(low, high, share);
}

float kernel(ivec2 texel) {
    float before = height_at(height, place_on(textureSize(height, 0), texel, size));
    float metres = before * relief + base_elevation;
    float inside = strength * smoothstep(between.x - 0.5 * thickness, between.x, metres)
                 * (1.0 - smoothstep(between.y, between.y + 0.5 * thickness, metres));
    float fold = 0.0;
    if (folds > 0.0) {
        vec2 place = share_of_texel(texel, size) * extent;
        fold = folds * gradient_fbm_periodic(place / fold_width, ivec2(1 << 20), 3, 0.5,
                                             seed + SALT + 1u);
    }
    float moved = stepped(metres + fold) - metres - fold;
    return relief > 0.0 ? before + inside * moved / relief : before;
}
