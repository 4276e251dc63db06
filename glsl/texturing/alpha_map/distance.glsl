// texturing/alpha_map/distance.glsl -- far from the eye one layer gives way to another.
//
//   gives    weights, whose sum is 1 in every texel
//   needs    terrain/heightfield.glsl, texturing/splat_weights.glsl; weights as of
//            texturing/alpha_map, of any size, and a height 0..1
//   units    metres from the eye to the terrain; weights 0..1
//   source   Belaiche 2010, section 2.8: where depth is a criterion, the texture changes with
//            the point of view, as in splatting
//   tested   tests/glsl/test_splat_rules.py, against distances in float64
//
// A pass of its own: whatever names the eye runs again whenever the camera moves, and the
// rules before it need not.
#include "terrain/heightfield.glsl"
#include "texturing/splat_weights.glsl"
#pragma kernel(output = "weights:rgba8")

uniform sampler2D weights;  //! input("linear")
uniform sampler2D height;   //! input

uniform int near = 0;       //! menu("grass", "rock", "snow", "path") label("Near layer")
                            //! What lies near the eye
uniform int far = 3;        //! menu("grass", "rock", "snow", "path") label("Far layer")
                            //! What takes its place far away
uniform float begins = 500.0;  //! log_slider(1, 100000) unit("m") How far away it begins to
uniform float ends = 1500.0;   //! log_slider(1, 100000) unit("m")
                               //! How far away nothing of it is left

vec4 unit(int layer) {
    return vec4(equal(ivec4(layer), ivec4(0, 1, 2, 3)));
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(weights, 0);
    vec4 share = textureLod(weights, (place_on(grid, texel, size) + 0.5) / vec2(grid), 0.0);
    vec3 place = vec3(share_of_texel(texel, size) * extent,
                      relief * height_at(height, place_on(textureSize(height, 0), texel, size)));
    float eye_distance = distance(eye, place);
    float gone = clamp((eye_distance - begins) / max(ends - begins, 1e-3), 0.0, 1.0);
    // Terrain that is not a number is nowhere.
    float moved = gone >= 0.0 ? gone * dot(share, unit(near)) : 0.0;
    return weights_in_bytes(share + moved * (unit(far) - unit(near)));
}
