// clouds/shadow.glsl -- what clouds leave of the sun's beam at a point below them.
//
//   gives    cloud_transmittance, cloud_share, cloud_mean, tile_of
//   needs    clouds/layer_form.glsl; a tile by clouds/field, read "linear", "repeat", "mipmap";
//            the texel by clouds/drift: metres east and north, the layer's base, a tile's width
//   units    metres, z over the terrain's height 0; transmittance 0..1
//   source   the layer's own transmittance where the sun's ray meets it: Wang 2003, "Realistic and
//            Fast Cloud Rendering", Journal of Graphics Tools 8(3); half shadows by the tile's
//            mean under the sun's disc, which the levels of detail hold: made here
//   tested   tests/glsl/test_cloud_shadows.py: shadows lie where the sun's ray meets the cloud
//
// A cloud's shadow is sharp below it and blurs with the distance d along the ray, by the sun's
// width of 0.53 degrees: 0.0093 d across the ray, and 1 / sin(elevation) as much along it. For a
// level of detail of square texels the geometric mean of the two is taken. So as the sun sets, its
// beam becomes the mean of all clouds.
#ifndef CLOUDS_SHADOW
#define CLOUDS_SHADOW
#include "clouds/layer_form.glsl"

const float SUN_WIDTH = 0.00925;  // 2 tan 0.265 degrees

// The place in the tile, in tiles, of a place in the layer.
vec2 tile_of(vec2 metres, vec4 drift) {
    return (metres - drift.xy) / drift.w;
}

// `apart`: as far as points are apart that are looked at [m], no finer detail is read.
float cloud_transmittance(sampler2D cloud, vec4 drift, vec3 point, vec3 sun, float apart) {
    float sine = max(sun.z, 1e-3);
    float up = max(drift.z + CLOUD_MIDDLE - point.z, 0.0);
    vec2 there = point.xy + sun.xy / sine * up;
    float texel = drift.w / float(textureSize(cloud, 0).x);
    float blur = max(max(SUN_WIDTH * up / (sine * sqrt(sine)), apart) / texel, 1.0);
    float left = textureLod(cloud, tile_of(there, drift), log2(blur)).a;
    // Within the layer, what is above a point thins out.
    return mix(1.0, left, clamp(up / CLOUD_MIDDLE, 0.0, 1.0));
}

float cloud_transmittance(sampler2D cloud, vec4 drift, vec3 point, vec3 sun) {
    return cloud_transmittance(cloud, drift, point, sun, 0.0);
}

// The mean over the tile: what all of the terrain receives.
float cloud_mean(sampler2D cloud) {
    return max(textureLod(cloud, vec2(0.5), 99.0).a, 1e-4);
}

// What the beam is there over that mean: it multiplies a beam that the cover has dimmed already.
float cloud_share(sampler2D cloud, vec4 drift, vec3 point, vec3 sun) {
    return cloud_transmittance(cloud, drift, point, sun) / cloud_mean(cloud);
}
#endif
