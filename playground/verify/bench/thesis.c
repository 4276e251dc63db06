/* The thesis's methods as its pseudo-code has them, to be timed beside the shaders.
 *
 * Belaiche 2010: layers (its "Perlin"), section 1.3.9; diamond-square and the mixed model,
 * section 4.3.1; detail in tiles, sections 4.3.2 to 4.3.4. Rows are allocated one by one,
 * heights of layers are whole numbers 0..255, and numbers come from rand(), as there.
 * What is fixed: the nodes' lower bound (slip 4), and the normalisation, to 255.
 *
 * Compiled by peers.py:  cc -O2 -shared -fPIC thesis.c thesis_light.c -lm
 */
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct layer {
    int **v;
    int side;
    float persistence;
};

static struct layer make_layer(int side, float persistence) {
    struct layer made = {malloc(side * sizeof(int *)), side, persistence};
    for (int i = 0; i < side; i++) made.v[i] = calloc(side, sizeof(int));
    return made;
}

static void free_layer(struct layer *layer) {
    for (int i = 0; i < layer->side; i++) free(layer->v[i]);
    free(layer->v);
}

static float **make_heights(int side) {
    float **made = malloc(side * sizeof(float *));
    for (int i = 0; i < side; i++) made[i] = calloc(side, sizeof(float));
    return made;
}

static void give(float **heights, int side, float *out) {
    for (int i = 0; i < side; i++) {
        memcpy(out + (size_t)i * side, heights[i], side * sizeof(float));
        free(heights[i]);
    }
    free(heights);
}

static int between(int from, int to, int n, int delta) {
    if (n == 0) return from;
    float a = (float)delta / n;
    float v1 = 3 * pow(1 - a, 2) - 2 * pow(1 - a, 3);
    float v2 = 3 * pow(a, 2) - 2 * pow(a, 3);
    return from * v1 + to * v2;
}

static int interpolated(int i, int j, int frequency, const struct layer *r) {
    float step = (float)r->side / frequency;
    int q = (float)i / step;
    int x1 = q * step, x2 = (q + 1) * step;
    if (x2 >= r->side) x2 = r->side - 1;
    q = (float)j / step;
    int y1 = q * step, y2 = (q + 1) * step;
    if (y2 >= r->side) y2 = r->side - 1;
    int v1 = between(r->v[x1][y1], r->v[x1][y2], y2 - y1, j - y1);
    int v2 = between(r->v[x2][y1], r->v[x2][y2], y2 - y1, j - y1);
    return between(v1, v2, x2 - x1, i - x1);
}

static struct layer *make_layers(int side, int frequency, int octaves, float persistence) {
    struct layer random = make_layer(side, 1);
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) random.v[i][j] = (unsigned char)((float)rand() / RAND_MAX * 255);
    struct layer *layers = malloc(octaves * sizeof(struct layer));
    int now = frequency;
    float weight = persistence;
    for (int n = 0; n < octaves; n++) {
        layers[n] = make_layer(side, weight);
        for (int i = 0; i < side; i++)
            for (int j = 0; j < side; j++) layers[n].v[i][j] = interpolated(i, j, now, &random);
        now *= frequency;
        weight *= persistence;
    }
    free_layer(&random);
    return layers;
}

static float sum_of_weights(const struct layer *layers, int octaves) {
    float sum = 0;
    for (int n = 0; n < octaves; n++) sum += layers[n].persistence;
    return sum;
}

static void free_layers(struct layer *layers, int octaves) {
    for (int n = 0; n < octaves; n++) free_layer(&layers[n]);
    free(layers);
}

/* Layered noise: side * side heights, 0..255. */
void layered_noise(float *out, int side, int frequency, int octaves, float persistence, unsigned seed) {
    srand(seed);
    struct layer *layers = make_layers(side, frequency, octaves, persistence);
    float weights = sum_of_weights(layers, octaves);
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            float sum = 0;
            for (int n = 0; n < octaves; n++) sum += layers[n].v[i][j] * layers[n].persistence;
            out[(size_t)i * side + j] = sum / weights;
        }
    free_layers(layers, octaves);
}

static float randomized(void) { return (float)rand() / RAND_MAX; }

static float centre(float **v, int side, int i, int j, int half) {
    float sum = 0;
    int n = 0;
    if (i >= half && j >= half) sum += v[i - half][j - half], n++;
    if (i >= half && j + half < side) sum += v[i - half][j + half], n++;
    if (i + half < side && j >= half) sum += v[i + half][j - half], n++;
    if (i + half < side && j + half < side) sum += v[i + half][j + half], n++;
    return sum / n;
}

static float edge(float **v, int side, int i, int j, int half) {
    float sum = 0;
    int n = 0;
    if (i >= half) sum += v[i - half][j], n++;
    if (i + half < side) sum += v[i + half][j], n++;
    if (j >= half) sum += v[i][j - half], n++;
    if (j + half < side) sum += v[i][j + half], n++;
    return sum / n;
}

static float **shape(int side, float smoothing) {
    float **v = make_heights(side);
    v[0][0] = v[0][side - 1] = v[side - 1][0] = v[side - 1][side - 1] = 0.5f * side;
    for (int spacing = side - 1; spacing > 1; spacing /= 2) {
        int half = spacing / 2;
        for (int i = half; i < side; i += spacing)
            for (int j = half; j < side; j += spacing)
                v[i][j] = centre(v, side, i, j, half) + randomized() * spacing * smoothing;
        for (int i = 0; i < side; i += half)
            for (int j = (i / half) % 2 == 0 ? half : 0; j < side; j += spacing)
                v[i][j] = edge(v, side, i, j, half) + randomized() * spacing * smoothing;
    }
    float highest = v[0][0];
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++)
            if (v[i][j] > highest) highest = v[i][j];
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) v[i][j] = v[i][j] * 255 / highest;
    return v;
}

/* Diamond-square, normalised: side * side heights up to 255, side a power of two and one more. */
void diamond_square(float *out, int side, float smoothing, unsigned seed) {
    srand(seed);
    give(shape(side, smoothing), side, out);
}

/* The mixed model: diamond-square as a layer of weight 1, and layers of detail. */
void mixed(float *out, int side, float smoothing, int frequency, int octaves, float persistence, unsigned seed) {
    srand(seed);
    float **v = shape(side, smoothing);
    struct layer *layers = make_layers(side, frequency, octaves, persistence);
    float weights = sum_of_weights(layers, octaves);
    for (int i = 0; i < side; i++)
        for (int j = 0; j < side; j++) {
            float sum = v[i][j];
            for (int n = 0; n < octaves; n++) sum += layers[n].v[i][j] * layers[n].persistence;
            v[i][j] = sum / (weights + 1);
        }
    free_layers(layers, octaves);
    give(v, side, out);
}
