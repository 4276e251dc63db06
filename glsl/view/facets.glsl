// view/facets.glsl -- the light on a face of the mesh by its own normal.
//
//   gives    light_of_face; in a draw's fragment stage only
//   needs    lighting/sun.glsl; derivatives
//   units    metres; light without unit
//   source   Belaiche 2010, figure 1.3; the normal from derivatives made here
//   tested   tests/glsl/test_facets.py, against the normals of the faces in float64
#ifndef VIEW_FACETS
#define VIEW_FACETS
#ifdef FRAGMENT_STAGE
#include "lighting/sun.glsl"

// The light on the plane that a pixel's neighbours share with it: a face of the mesh.
float light_of_face(vec3 position, vec2 sun, float ambient) {
    vec3 normal = normalize(cross(dFdx(position), dFdy(position)));
    // Which side is up depends on how the picture is turned, not on the terrain.
    normal *= normal.z < 0.0 ? -1.0 : 1.0;
    return sun_on(normal, to_sun(sun)) + ambient * (0.5 + 0.5 * normal.z);
}
#endif
#endif
