/* The thesis's methods of light as its pseudo-code has them, to be timed beside the shaders.
 *
 * Belaiche 2010: L·N, section 3.5.3; the ray, section 3.5.4; the cone, section 4.4.2. Heights
 * are grey levels 0..255, one texel is as long as one grey level is high, and a place's height
 * is that of the texel it is cut down to. The light map has the terrain's size, so the change of
 * frame at each method's beginning is left out. (lx, ly, lz) is the unit vector towards the sun,
 * along which the walks go; L·N takes its opposite, as there.
 *
 * What is fixed: L·N at the border, where the thesis looks beyond the terrain, is that of the
 * nearest texel which has its neighbours; a cone that widens as fast as the sun climbs still ends
 * at the terrain's edge, as there.
 *
 * Compile with:  cc -O2 -shared -fPIC thesis_light.c -lm
 */
#include <math.h>

#define HIGHEST 255.0f
#define BRIGHTNESS 2.0

typedef struct {
    double x, y, z;
} vector;

typedef struct {
    float x, y, z;
} point;

static float height_of(const float *heights, int i, int j, int side) {
    return heights[j * side + i];
}

static void normalise(vector *v) {
    double length = sqrt(v->x * v->x + v->y * v->y + v->z * v->z);
    v->x /= length;
    v->y /= length;
    v->z /= length;
}

static double l_dot_n_of(const float *heights, int i, int j, int side, float lx, float ly, float lz) {
    vector v1, v2, n;
    if (i < 1) i = 1;
    if (j < 1) j = 1;
    if (i > side - 2) i = side - 2;
    if (j > side - 2) j = side - 2;
    v1.x = 2;
    v1.y = 0;
    v1.z = height_of(heights, i + 1, j - 1, side) - height_of(heights, i - 1, j - 1, side);
    v2.x = 0;
    v2.y = 2;
    v2.z = height_of(heights, i + 1, j + 1, side) - height_of(heights, i + 1, j - 1, side);
    normalise(&v1);
    normalise(&v2);
    n.x = v1.y * v2.z - v1.z * v2.y;
    n.y = v1.z * v2.x - v1.x * v2.z;
    n.z = v1.x * v2.y - v1.y * v2.x;
    normalise(&n);
    if (n.z < 0) {
        n.x *= -1;
        n.y *= -1;
        n.z *= -1;
    }
    double product = -lx * n.x - ly * n.y - lz * n.z;
    return product < 0 ? -BRIGHTNESS * product : 0;
}

static double ray_of(const float *heights, int i, int j, int side, float lx, float ly, float lz) {
    point at = {i, j, height_of(heights, i, j, side)};
    while (at.x >= 0 && at.y >= 0 && at.x < side && at.y < side) {
        float land = height_of(heights, (int)at.x, (int)at.y, side);
        if (at.z > HIGHEST) break;
        if (land > at.z) return 0;
        at.x += lx;
        at.y += ly;
        at.z += lz;
    }
    return l_dot_n_of(heights, i, j, side, lx, ly, lz);
}

static double cone_of(const float *heights, int i, int j, int side, float lx, float ly, float lz, float delta_r) {
    point at = {i, j, height_of(heights, i, j, side)};
    double visible = 1, found = 2, radius = 0;
    while (at.x >= 0 && at.y >= 0 && at.x < side && at.y < side) {
        float land = height_of(heights, (int)at.x, (int)at.y, side);
        if (at.z > HIGHEST + radius) break;
        if (land > at.z + radius) return 0;
        if (radius != 0) found = (at.z + radius - land) / (2 * radius);
        if (found < visible) visible = found;
        radius += delta_r;
        at.x += lx;
        at.y += ly;
        at.z += lz;
    }
    return visible * l_dot_n_of(heights, i, j, side, lx, ly, lz);
}

void l_dot_n(const float *heights, float *out, int side, float lx, float ly, float lz) {
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) out[j * side + i] = l_dot_n_of(heights, i, j, side, lx, ly, lz);
}

void ray_cast(const float *heights, float *out, int side, float lx, float ly, float lz) {
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) out[j * side + i] = ray_of(heights, i, j, side, lx, ly, lz);
}

void soft_cone(const float *heights, float *out, int side, float lx, float ly, float lz, float delta_r) {
    for (int j = 0; j < side; j++)
        for (int i = 0; i < side; i++) out[j * side + i] = cone_of(heights, i, j, side, lx, ly, lz, delta_r);
}
