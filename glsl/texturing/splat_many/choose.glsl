// texturing/splat_many/choose.glsl -- which four of sixteen materials a place shows.
//
//   gives    chosen, the numbers of four materials from 0 in 255ths, the most first; weights,
//            theirs, which sum to 1 in every texel
//   needs    noise/periodic.glsl, terrain/heightfield.glsl, texturing/splat_weights.glsl; a height
//   units    bands: height from and to, 0..1 where normalised; slope from and to in degrees
//   source   Belaiche 2010, section 2.5, has four layers; more of them, and how four are
//            chosen: made here
//   tested   tests/glsl/test_splat_many.py, against sorting in float64
//
// A material's claim is how far a place lies inside its bands, times chance. The four largest
// claims count, less the fifth: so a material that is about to be left out has faded to 0
// already, and no line is seen where the list changes. Only where five claims are equal over an
// area, as whole ones without chance are, may one that ends there take the place of another.
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#include "texturing/splat_weights.glsl"
#pragma kernel(output = "chosen:rgba8, weights:rgba8")

uniform sampler2D height;  //! input

uniform vec4 band_1 = vec4(0.0, 0.12, 0.0, 20.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 1
uniform vec4 band_2 = vec4(0.0, 0.2, 0.0, 90.0);  //! group("Bands")
                                                  //! parts("from", "to", "slope from", "slope to")
                                                  //! Height from and to, slope from and to in
                                                  //! degrees, of material 2
uniform vec4 band_3 = vec4(0.05, 0.3, 0.0, 14.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 3
uniform vec4 band_4 = vec4(0.08, 0.45, 0.0, 24.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 4
uniform vec4 band_5 = vec4(0.1, 0.5, 8.0, 30.0);  //! group("Bands")
                                                  //! parts("from", "to", "slope from", "slope to")
                                                  //! Height from and to, slope from and to in
                                                  //! degrees, of material 5
uniform vec4 band_6 = vec4(0.2, 0.6, 0.0, 22.0);  //! group("Bands")
                                                  //! parts("from", "to", "slope from", "slope to")
                                                  //! Height from and to, slope from and to in
                                                  //! degrees, of material 6
uniform vec4 band_7 = vec4(0.25, 0.7, 10.0, 34.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 7
uniform vec4 band_8 = vec4(0.35, 0.75, 0.0, 26.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 8
uniform vec4 band_9 = vec4(0.15, 0.6, 26.0, 48.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 9
uniform vec4 band_10 = vec4(0.3, 0.85, 28.0, 56.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 10
uniform vec4 band_11 = vec4(0.5, 1.0, 30.0, 90.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 11
uniform vec4 band_12 = vec4(0.1, 0.8, 44.0, 90.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 12
uniform vec4 band_13 = vec4(0.55, 0.9, 14.0, 34.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 13
uniform vec4 band_14 = vec4(0.6, 0.95, 0.0, 20.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 14
uniform vec4 band_15 = vec4(0.7, 1.0, 0.0, 36.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 15
uniform vec4 band_16 = vec4(0.82, 1.0, 0.0, 44.0);  //! group("Bands")
    //! parts("from", "to", "slope from", "slope to")
    //! Height from and to, slope from and to in degrees, of material 16
uniform int materials = 16;           //! slider(1, 16) How many there are, from the first on
uniform float height_fade = 0.08;     //! slider(0.001, 1) step(0.001)
                                      //! Over how much height a band begins and ends
uniform float slope_fade = 8.0;       //! slider(0.1, 45) step(0.1) unit("degrees")
                                      //! Over how much slope it does
uniform float chance = 0.7;           //! slider(0, 1) step(0.01) group("Chance")
                                      //! How much of a claim is random: patches of materials that
                                      //! all would fit
uniform float grain = 120.0;          //! log_slider(1, 2000) unit("m") group("Chance")
                                      //! How wide the largest patches are
uniform uint seed = 1u;               //! slider(0, 9999) group("Chance") Which random numbers

const uint SALT = 0xb9faabefu;  // CRC-32 of "texturing/splat_many"

float rise(float value, float from, float fade) {
    return clamp((value - from) / fade + 0.5, 0.0, 1.0);
}

// The claim of a material, given the height, the slope and a place in patches.
float claim(int number, vec4 band, vec2 site, vec2 patch_place) {
    if (number >= materials) return 0.0;
    float fits = rise(site.x, band.x, height_fade) * rise(-site.x, -band.y, height_fade)
               * rise(site.y, band.z, slope_fade) * rise(-site.y, -band.w, slope_fade);
    // Noise is 0 on its lattice: on one lattice all materials would tie there.
    vec2 moved = patch_place + float(number) * vec2(0.618, 0.382);
    uint own = 64u * seed + SALT + 4u * uint(number);
    float luck = 0.5 + 1.2 * gradient_fbm_periodic(moved, ivec2(1 << 20), 3, 0.5, own);
    return fits * mix(1.0, clamp(luck, 0.0, 1.0), chance);
}

// Claims in order, the largest first, each with its number. A new one goes in where it belongs.
void insert(float found, float number, inout vec4 largest, inout vec4 numbers, inout float fifth) {
    vec4 before = largest;
    vec4 named = numbers;
    bvec4 under = lessThan(before, vec4(found));
    fifth = max(fifth, under.w ? before.w : found);
    largest = vec4(under.x ? found : before.x,
                under.x ? before.x : under.y ? found : before.y,
                under.y ? before.y : under.z ? found : before.z,
                under.z ? before.z : under.w ? found : before.w);
    numbers = vec4(under.x ? number : named.x,
                   under.x ? named.x : under.y ? number : named.y,
                   under.y ? named.y : under.z ? number : named.z,
                   under.z ? named.z : under.w ? number : named.w);
}

void kernel(ivec2 texel, out vec4 chosen, out vec4 weights) {
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    vec2 metres = spacing_of(grid, extent);
    float incline = degrees(atan(length(relief
                                        * slope_at(height, place, metres, CENTRAL_DIFFERENCES))));
    vec2 site = vec2(height_at(height, place), incline);
    // Terrain that is not a number has the first material, and stays visible as such in the view.
    if (!(abs(site.x) < 1e30 && abs(site.y) < 1e30)) site = vec2(band_1.x, 0.0);
    vec2 patch_place = share_of_texel(texel, size) * extent / grain;
    // Where nothing claims, the first material lies.
    vec4 largest = vec4(1e-6, 0.0, 0.0, 0.0);
    vec4 numbers = vec4(0.0);
    float fifth = 0.0;
    insert(claim(0, band_1, site, patch_place), 0.0, largest, numbers, fifth);
    insert(claim(1, band_2, site, patch_place), 1.0, largest, numbers, fifth);
    insert(claim(2, band_3, site, patch_place), 2.0, largest, numbers, fifth);
    insert(claim(3, band_4, site, patch_place), 3.0, largest, numbers, fifth);
    insert(claim(4, band_5, site, patch_place), 4.0, largest, numbers, fifth);
    insert(claim(5, band_6, site, patch_place), 5.0, largest, numbers, fifth);
    insert(claim(6, band_7, site, patch_place), 6.0, largest, numbers, fifth);
    insert(claim(7, band_8, site, patch_place), 7.0, largest, numbers, fifth);
    insert(claim(8, band_9, site, patch_place), 8.0, largest, numbers, fifth);
    insert(claim(9, band_10, site, patch_place), 9.0, largest, numbers, fifth);
    insert(claim(10, band_11, site, patch_place), 10.0, largest, numbers, fifth);
    insert(claim(11, band_12, site, patch_place), 11.0, largest, numbers, fifth);
    insert(claim(12, band_13, site, patch_place), 12.0, largest, numbers, fifth);
    insert(claim(13, band_14, site, patch_place), 13.0, largest, numbers, fifth);
    insert(claim(14, band_15, site, patch_place), 14.0, largest, numbers, fifth);
    insert(claim(15, band_16, site, patch_place), 15.0, largest, numbers, fifth);
    vec4 left = largest - fifth;
    // Five that claim alike would leave nothing.
    if (left.x < 1e-6) left = largest;
    chosen = numbers / 255.0;
    weights = weights_in_bytes(left / (left.x + left.y + left.z + left.w));
}
