// lighting/sun_disc/area.glsl -- the part of a disc's area over a level line.
//
//   gives    disc_above, disc_over, tangent_of
//   needs    nothing: pure functions, no uniforms, no textures
//   units    degrees; tangents: rise over run; parts 0..1
//   source   the area of a circular segment, r² (a - sin a cos a) for the half angle a
//   tested   tests/glsl/test_shadows.py, against quadrature
#ifndef LIGHTING_SUN_DISC_AREA
#define LIGHTING_SUN_DISC_AREA

// The part of a disc over a line that lies `line` radii over its centre.
float disc_above(float line) {
    float x = clamp(line, -1.0, 1.0);
    float y = sqrt(max(1.0 - x * x, 0.0));
    // acos is rough on many GPUs; atan is not.
    return clamp((atan(y, x) - x * y) * 0.318309886, 0.0, 1.0);
}

// The part of a disc at that elevation, so wide, over a horizon.
float disc_over(float tangent, float elevation, float diameter) {
    return disc_above((degrees(atan(tangent)) - elevation) / (0.5 * diameter));
}

// An elevation's tangent; straight up, a very large one.
float tangent_of(float elevation) {
    return elevation > 89.99 ? 1e6 : tan(radians(max(elevation, -89.99)));
}
#endif
