// clouds/billows_reading.glsl -- a look at the texture by clouds/billows.
//
//   gives    BILLOWS, BILLOWS_ACROSS, BILLOWS_MEAN, billows_at
//   needs    the texture, read "linear"; its size is BILLOWS_ACROSS * (BILLOWS + 2) on each axis
//   units    places in cubes, after one of which all comes again
//   source   none: a texture's layout
//   tested   tests/glsl/test_cloud_light.py: its layout, its mean
#ifndef CLOUDS_BILLOWS_READING
#define CLOUDS_BILLOWS_READING

const int BILLOWS = 32;          // voxels of the cube, on each axis
const int BILLOWS_ACROSS = 6;    // slices side by side
const float BILLOWS_MEAN = 0.695;

float billows_at(sampler2D billows, vec3 place) {
    vec3 voxel = fract(place) * float(BILLOWS);
    float between = voxel.z - 0.5 + (voxel.z < 0.5 ? float(BILLOWS) : 0.0);
    int slice = int(between);
    vec2 corner = vec2(slice % BILLOWS_ACROSS, slice / BILLOWS_ACROSS) * float(BILLOWS + 2) + 1.0;
    vec2 two = textureLod(billows, (corner + voxel.xy) / vec2(textureSize(billows, 0)), 0.0).rg;
    return mix(two.x, two.y, between - float(slice));
}
#endif
