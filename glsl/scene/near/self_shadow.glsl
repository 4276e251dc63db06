// scene/near/self_shadow.glsl -- a rough ground receives no more light than a smooth one.
//
//   gives    sun_past_bumps, facing_of_bumps, sky_on_bumps
//   needs    nothing: pure functions, no uniforms, no textures
//   units    unit vectors; variances of slopes along an axis; shares 0..1
//   source   Smith 1967, "Geometrical Shadowing of a Random Rough Surface" (IEEE Transactions on
//            Antennas and Propagation 15); the fraction: Walter and others 2007, "Microfacet
//            Models for Refraction through Rough Surfaces" (EGSR), section 5.3
//   tested   tests/glsl/test_near.py: the mean over many bumps is the light of the smooth ground
//
// A rough ground receives what its area receives, whatever its bumps: no more, and no less. Two
// things would break that. The cosine of a bump's own normal falls on more ground than its
// area seen from above, so it is divided by the normal's part along the ground's. And of faces
// turned away the cosine cannot be negative, though the light that they miss reaches none behind
// them either: they throw shadows, which Smith's share takes off.
#ifndef SCENE_NEAR_SELF_SHADOW
#define SCENE_NEAR_SELF_SHADOW

// What is left of a sun that stands at this cosine over the smooth ground, on faces turned to it.
float sun_past_bumps(float facing, float variance) {
    if (facing <= 0.0) return variance > 0.0 ? 0.0 : 1.0;
    float across = variance * max(1.0 - facing * facing, 0.0);
    float a = facing * inversesqrt(max(2.0 * across, 1e-12));
    return a < 1.6 ? a * (3.535 + 2.181 * a) / (1.0 + a * (2.276 + 2.577 * a)) : 1.0;
}

// The cosine of a bump's normal over the area that the bump has of the ground.
float facing_of_bumps(vec3 bump, vec3 ground, vec3 to_sun) {
    return dot(bump, to_sun) / max(dot(bump, ground), 0.2);
}
// What a bump receives of the sky over what the smooth ground does: more where it faces up, or
// the sun's side of the sky. It is linear in the bump, so its mean is 1.
float sky_on_bumps(vec3 bump, vec3 ground, vec3 to_sun) {
    vec3 tilt = bump / max(dot(bump, ground), 0.2) - ground;
    return max(1.0 + dot(tilt, vec3(0.3 * to_sun.xy, 0.45)), 0.2);
}
#endif
