// sky/clouds.glsl -- how a cover of cloud dims the sun and whitens the sky.
//
//   gives    under_clouds, beam_through_clouds, overcast
//   needs    nothing: pure functions, no uniforms, no textures
//   units    cover 0..1; shares of the light without clouds
//   source   Kasten and Czeplak 1980, "Solar and terrestrial radiation dependent on the amount and
//            type of cloud", Solar Energy 24: all light 1 - 0.75 N^3.4, and of that 0.3 + 0.7 N²
//            from the sky; Moon and Spencer 1942, "Illumination from a non-uniform sky", which is
//            the CIE's overcast sky: (1 + 2 sin elevation) / 3
//   tested   tests/glsl/test_daylight.py, against the formulas at their ends and the sky's mean
#ifndef SKY_CLOUDS
#define SKY_CLOUDS

// All light on level ground, sun and sky, over that without clouds.
float under_clouds(float cover) {
    return 1.0 - 0.75 * pow(max(cover, 0.0), 3.4);
}

// The sun's own part over that without clouds: what is not the sky's, 0.7 (1 - N²) of 0.7.
float beam_through_clouds(float cover) {
    return under_clouds(cover) * (1.0 - cover * cover);
}

// An overcast sky whose light on level ground is 1, by the sine of the elevation.
float overcast(float rise) {
    return (1.0 + 2.0 * rise) * (3.0 / 7.0);
}
#endif
