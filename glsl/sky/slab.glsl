// sky/slab.glsl -- one step of a path through lit air.
//
//   gives    Slab, slab, slab_with_drops
//   needs    sky/columns.glsl
//   units    kilometres; light per unit of the sun's outside the air, phases left out
//   source   Nishita, Sirai, Tadamura and Nakamae 1993, "Display of the Earth Taking into Account
//            Atmospheric Scattering"; the mean over a step of light that fades in it as in
//            Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering
//            Technique"
//   tested   tests/glsl/test_air.py, against float64
//
// What it scatters once, and what it lets through.
#ifndef SKY_SLAB
#define SKY_SLAB
#include "sky/columns.glsl"

struct Slab {
    float height;
    float sun_rise;   // of the sun, over the slab's own horizon
    vec3 molecules;   // sunlight that molecules scatter towards the eye, all directions together
    vec3 aerosol;     // and aerosol
    vec3 share;       // of light from all around that both scatter
    vec3 drops;       // of light that comes to drops, if there are any
    vec3 left;        // of light from behind
};

// `before` to `after` along a path from `from`; `together` is the cosine between path and sun.
// Drops of an optical depth `mist` hang in it evenly.
Slab slab_with_drops(sampler2D columns, Air air, float from, float rise, float sun_rise,
                     float together, float before, float after, float mist) {
    float middle = 0.5 * (before + after);
    Slab found;
    found.height = clamp(height_along(from, rise, middle), 0.0, AIR_HEIGHT);
    found.sun_rise = ((EARTH_RADIUS + from) * sun_rise + middle * together)
            / (EARTH_RADIUS + found.height);
    vec3 amounts = densities(found.height);
    vec3 taken = extinction(air, amounts);
    vec3 depth = taken * (after - before) + mist;
    found.left = exp(-depth);
    // (1 - e^-x) / x, whose quotient cancels where the air is thin.
    vec3 mean = mix((1.0 - found.left) / max(depth, 1e-6), 1.0 - depth * (0.5 - depth / 6.0),
                    vec3(lessThan(depth, vec3(1e-2))));
    vec3 length_seen = mean * (after - before);
    vec3 by_molecules = length_seen * air.molecules * amounts.x;
    vec3 by_aerosol = length_seen * air.aerosol * (AEROSOL_ALBEDO * amounts.y);
    vec3 sunlight = left_of_sunlight(columns, air, found.height, found.sun_rise);
    found.molecules = by_molecules * sunlight;
    found.aerosol = by_aerosol * sunlight;
    found.share = by_molecules + by_aerosol;
    found.drops = mean * mist;
    return found;
}

Slab slab(sampler2D columns, Air air, float from, float rise, float sun_rise, float together,
          float before, float after) {
    return slab_with_drops(columns, air, from, rise, sun_rise, together, before, after, 0.0);
}
#endif
