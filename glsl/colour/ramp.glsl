// colour/ramp.glsl -- a number 0..1 as a colour that people with colour-blindness can order, too.
//
//   gives    ramp_blue_yellow
//   needs    nothing: pure functions, no uniforms, no textures
//   units    0..1 in, sRGB-encoded colour out
//   source   made here: five stops from dark blue to pale yellow whose lightness rises
//            evenly, and whose order survives the loss of red or of green
//   tested   tests/glsl/test_colour.py: lightness rises at every step
#ifndef COLOUR_RAMP
#define COLOUR_RAMP

vec3 ramp_blue_yellow(float share) {
    const vec3 s0 = vec3(0.05, 0.07, 0.29);
    const vec3 s1 = vec3(0.13, 0.28, 0.49);
    const vec3 s2 = vec3(0.35, 0.47, 0.52);
    const vec3 s3 = vec3(0.72, 0.67, 0.42);
    const vec3 s4 = vec3(0.99, 0.93, 0.62);
    float t = clamp(share, 0.0, 1.0) * 4.0;
    if (t < 1.0) return mix(s0, s1, t);
    if (t < 2.0) return mix(s1, s2, t - 1.0);
    if (t < 3.0) return mix(s2, s3, t - 2.0);
    return mix(s3, s4, t - 3.0);
}
#endif
