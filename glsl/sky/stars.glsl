// sky/stars.glsl -- stars, as many of each brightness as there are, and the Milky Way.
//
//   gives    celestial_of, stars_towards, milky_way
//   needs    noise/hash.glsl: pure functions, no uniforms, no textures
//   units    angles in degrees, spreads in radians; light without unit, 1 that of the sun
//            outside the air, of what is as bright as a white surface in as much light
//   source   numbers of stars over the whole sky brighter than magnitude m: 10^(0.51 m + 0.68),
//            fitted to those of the Bright Star Catalogue (Hoffleit and Warren 1991), 1,600 to
//            magnitude 5 and 9,100 to 6.5; the galaxy's pole: IAU 1958, for the equinox of 2000;
//            places are drawn by lot, so no constellation is there
//   tested   tests/glsl/test_stars.py: counts, light by size of pixel, the turning sky
//
// The sphere is cut into bands of declination, each into cells of equal width; a cell has one
// star or none, whole inside it, so that only the cell itself is looked at. Two such grids, the
// second turned, hide that there are cells. A star is as wide as the eye makes it, or as a pixel
// is: its light stays the same.
#ifndef SKY_STARS
#define SKY_STARS
#include "noise/hash.glsl"

const uint STARS_SALT = 0xea934279u;  // CRC-32 of "sky/stars"
const int STAR_BANDS = 112;           // of 1.6 degrees
const float FAINTEST = 6.92;          // 16,100 stars: one in each cell of one grid
const float STAR_LIGHT = 1.98e-11;    // of magnitude 0
const float STAR_WIDE = 0.0012;       // the least radius, as the eye sees them
const float WIDEST = 0.006;           // cells are wide enough for this
const float STAR_PI = 3.14159265;

// A direction in the world as one among the stars: x to the spring point, z to the pole.
vec3 celestial_of(vec3 towards, float latitude, float sidereal) {
    float low = radians(latitude);
    float turned = radians(sidereal);
    float south = cos(low) * towards.z - sin(low) * towards.y;
    float pole = sin(low) * towards.z + cos(low) * towards.y;
    return vec3(cos(turned) * south - sin(turned) * towards.x,
                sin(turned) * south + cos(turned) * towards.x, pole);
}

// The light of the star in a cell, spread over a disc of a radius.
vec3 star_of_grid(vec3 at, float radius, uint seed) {
    float band_wide = STAR_PI / float(STAR_BANDS);
    float declination = asin(clamp(at.z, -1.0, 1.0));
    int band = clamp(int((declination / STAR_PI + 0.5) * float(STAR_BANDS)), 0, STAR_BANDS - 1);
    float middle = (float(band) + 0.5) * band_wide - 0.5 * STAR_PI;
    float cells = max(floor(2.0 * STAR_PI * cos(middle) / band_wide + 0.5), 3.0);
    float ascension = (at.x == 0.0 && at.y == 0.0 ? 0.0 : atan(at.y, at.x)) / (2.0 * STAR_PI);
    float place = fract(ascension) * cells;
    uvec3 bits = hash3(uvec3(uint(place), uint(band), seed));
    uvec3 more = hash3(uvec3(uint(place), uint(band), seed + 1u));
    if (unit_from_bits(more.x) > 0.5) return vec3(0.0);
    // Whole inside the cell.
    vec2 inset = vec2(WIDEST * cells / (2.0 * STAR_PI * max(cos(middle), 0.02)),
                      WIDEST / band_wide);
    vec2 lot = mix(min(inset, 0.49), 1.0 - min(inset, 0.49),
                   vec2(unit_from_bits(bits.x), unit_from_bits(bits.y)));
    float east = (floor(place) + lot.x) / cells * 2.0 * STAR_PI;
    float north = middle + (lot.y - 0.5) * band_wide;
    vec3 star = vec3(cos(north) * cos(east), cos(north) * sin(east), sin(north));
    float off = distance(star, at) / radius;
    if (off >= 1.0) return vec3(0.0);
    float magnitude = FAINTEST + log2(max(unit_from_bits(bits.z), 1e-7)) * (0.30103 / 0.51);
    float light = STAR_LIGHT * exp2(-1.3287712 * magnitude);  // 10^(-0.4 m)
    float warm = unit_from_bits(more.y);
    vec3 colour = mix(vec3(0.85, 0.97, 1.25), vec3(1.25, 0.96, 0.70), warm * warm);
    float share = 1.0 - off * off;
    return colour * (light * share * share * 3.0 / (radius * radius));  // pi, over pi radius²/3
}

vec3 stars_towards(vec3 celestial, float pixel) {
    float radius = clamp(1.5 * pixel, STAR_WIDE, WIDEST);
    return star_of_grid(celestial, radius, STARS_SALT)
            + star_of_grid(celestial.yzx, radius, STARS_SALT + 64u);
}

// The light of the band of stars that are not told apart, some 21 magnitudes a square second
// of arc at its middle.
vec3 milky_way(vec3 celestial) {
    const vec3 POLE = vec3(-0.8676661, -0.1980764, 0.4559838);
    const vec3 CENTRE = vec3(-0.0548756, -0.8734371, -0.4838350);
    float across = dot(celestial, POLE);
    float along = 0.5 + 0.5 * dot(celestial, CENTRE);
    float wide = mix(0.10, 0.20, along);
    return vec3(1.0, 0.97, 0.95) * (1.0e-8 * mix(0.4, 1.2, along * along)
            * exp(-across * across / (wide * wide)));
}
#endif
