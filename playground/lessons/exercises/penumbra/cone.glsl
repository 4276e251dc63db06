// lessons/penumbra.glsl -- how much of the sun is seen along a ray that has a width.
//
//   gives    visibility: the free part of the ray, 0..1
//   needs    lessons/edge.glsl, terrain/heightfield.glsl
//   units    radii in metres, measured upright; visibility without unit
//   source   Belaiche 2010, section 4.4, eq. 4.3
//   tested   tests/glsl/test_lesson_shadows.py, against a march in float64, and against
//            lighting/soft_cone, lighting/soft_cylinder and lighting/ray_cast
//
// One kernel for three methods: a ray (both numbers 0), the thesis's cylinder, which fails (a
// width at the ground), and its cone (a width that grows from 0).
#include "lessons/edge.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;              //! input
uniform vec2 sun = vec2(270.0, 15.0);  //! direction Azimuth clockwise from north, elevation above
                                       //! the horizon
uniform float at_ground = 0.0;         //! slider(0, 200) step(1) unit("m")
                                       //! The ray's radius where it begins, on the ground
uniform float delta_r = 0.06;          //! slider(0, 2) step(0.001) label("Δr")
                                       //! What the radius grows over one metre of path

// The free part of a ray of that radius whose middle is so high over the terrain.
float free_part(float clearance, float radius) {
    if (radius == 0.0) return clearance < 0.0 ? 0.0 : 1.0;
    return clamp(0.5 + clearance / (2.0 * radius), 0.0, 1.0);
}

float kernel(ivec2 texel) {
    if (towards_sun.z < 0.0) return 0.0;
    vec2 way = towards_sun.xy / spacing;
    float path = 1.0 / max(max(abs(way.x), abs(way.y)), 1e-9);  // metres a step
    float foot = height_at(height, vec2(texel)) * relief;
    float visible = 1.0;
    for (int i = 0; i < max(size.x, size.y); i++) {
        float t = float(i) * path;                              // metres from the ground
        vec2 place = vec2(texel) + t * way;
        if (is_outside(height, place)) break;
        float ray = foot + t * towards_sun.z;
        float terrain = height_at(height, place) * relief;
        float radius = at_ground;
        visible = min(visible, free_part(ray - terrain, radius));
    }
    return visible;
}
