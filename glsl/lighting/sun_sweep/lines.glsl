// lighting/sun_sweep/lines.glsl -- parallel lines of sight over a grid, level with the light.
//
//   gives    Lines, lines_towards, slopes_around, row_and_across, texel_on, across_at, part_at,
//            heights_across, is_on_terrain, horizon_of_texel, NO_HORIZON, NOWHERE, NEAR_ROWS
//   needs    nothing of its own; the texture of heights comes as an argument
//   units    rows and places in texels; heights and lengths in metres; tangents: rise over run
//   source   derived here
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// Rows are counted from the sun's side, along the axis that the light follows more. A line moves
// by `drift` texels across the rows, each row. Lines are a texel apart: line n begins n texels
// across on row 0. So each texel is on a line, or between that line and the next.
#ifndef LIGHTING_SUN_SWEEP_LINES
#define LIGHTING_SUN_SWEEP_LINES

const float NO_HORIZON = -10000.0;  // a tangent below all others: no terrain towards the sun
const float NOWHERE = -1e30;        // a height where there is no terrain  [m]

// Terrain so many rows away or more is looked for along the lines, nearer terrain on the texel's
// own way to the light.
const int NEAR_ROWS = 4;

struct Lines {
    bool along_x;    // rows are counted along x, not y
    bool from_high;  // the sun is where x or y is greatest
    int rows;
    int last;        // texel of a row
    float drift;     // texels across, a row; -1..1
    float run;       // metres a row
};

Lines lines_towards(ivec2 grid, vec3 light, vec2 metres) {
    vec2 direction = light.xy / metres;
    bool along_x = abs(direction.x) >= abs(direction.y);
    float ahead = along_x ? direction.x : direction.y;
    float aside = along_x ? direction.y : direction.x;
    float drift = ahead == 0.0 ? 0.0 : -aside / abs(ahead);
    // Along an axis and a diagonal a line meets texels only, which rounding would undo.
    if (abs(drift) < 1e-6) drift = 0.0;
    if (abs(abs(drift) - 1.0) < 1e-6) drift = sign(drift);
    vec2 row = along_x ? vec2(1.0, drift) : vec2(drift, 1.0);
    ivec2 turned = along_x ? grid : grid.yx;
    return Lines(along_x, ahead > 0.0, turned.x, turned.y - 1, drift, length(row * metres));
}

// What represents the sun: a point, a cone around its ray, or a disc.
const int POINT = 0;
const int CONE = 1;  // `spread`: its radius over the way along the ray
const int DISC = 2;  // `spread`: its diameter in degrees

// Half of what tangents the sun covers, from its own.
float half_window(vec3 light, int shape, float spread) {
    float level = max(length(light.xy), 1e-6);
    return shape == POINT ? 0.0 : (shape == CONE ? spread : tan(radians(0.5 * spread)) / level)
            / level;
}

// Four slopes in what the sun covers, in metres a row.
vec4 slopes_around(Lines lines, vec3 light, int shape, float spread) {
    float tangent = light.z / max(length(light.xy), 1e-6);
    return (tangent + half_window(light, shape, spread) * vec4(-0.75, -0.25, 0.25, 0.75))
            * lines.run;
}

// Which row a texel of the terrain is on and how many texels across; and back.
ivec2 row_and_across(Lines lines, ivec2 texel) {
    ivec2 turned = lines.along_x ? texel : texel.yx;
    return ivec2(lines.from_high ? lines.rows - 1 - turned.x : turned.x, turned.y);
}
ivec2 texel_on(Lines lines, int row, int across) {
    int ahead = lines.from_high ? lines.rows - 1 - row : row;
    return lines.along_x ? ivec2(ahead, across) : ivec2(across, ahead);
}

// Where a line crosses a row: the texel at or before the crossing, and the part of a texel from
// there to it.
int across_at(Lines lines, int row, int line) {
    return line + int(floor(float(row) * lines.drift));
}
float part_at(Lines lines, int row) {
    float drifted = float(row) * lines.drift;
    return drifted - floor(drifted);
}

float height_across(sampler2D field, Lines lines, int row, int across) {
    return texelFetch(field, texel_on(lines, row, clamp(across, 0, lines.last)), 0).r;
}

// The heights of three texels from `across` on; height 1 is so many metres. Beside the terrain
// they are those of its edge.
vec3 heights_across(sampler2D field, Lines lines, int row, int across, float metres) {
    return metres * vec3(
        height_across(field, lines, row, across),
        height_across(field, lines, row, across + 1),
        height_across(field, lines, row, across + 2)
    );
}

// Whether a place so far after the texel `across` is on the terrain: lines beside it throw no
// shadow.
bool is_on_terrain(Lines lines, int across, float part) {
    return across >= 0 && across <= lines.last - (part > 0.0 ? 1 : 0);
}

// The horizon's tangent from a texel on a row, from those of the line at or before it and of the
// next line. `foot` is the texel's height; near1, near2 and near3 are the heights of three texels,
// from the first of these lines on, one to three rows nearer to the sun.
float horizon_of_texel(Lines lines, int row, int across, float before, float after, float foot,
                       vec3 near1, vec3 near2, vec3 near3) {
    // A line that has met no terrain knows nothing of what lies beside it.
    bool between = part_at(lines, row) > 0.0;
    if (between && before <= NO_HORIZON) before = after;
    if (after <= NO_HORIZON) after = before;
    float lead = between ? 1.0 - part_at(lines, row) : 0.0;
    float tangent = before + (after - before) * lead;
    // The texel's own way to the sun is `lead` texels after the first line. It leaves the terrain
    // at its sides.
    vec3 steps = vec3(1.0, 2.0, 3.0);
    vec3 at = lead
            + vec3(part_at(lines, row - 1), part_at(lines, row - 2), part_at(lines, row - 3));
    vec3 first = vec3(near1.x, near2.x, near3.x);
    vec3 second = vec3(near1.y, near2.y, near3.y);
    vec3 third = vec3(near1.z, near2.z, near3.z);
    vec3 terrain = mix(second + (third - second) * (at - 1.0), first + (second - first) * at,
                       lessThan(at, vec3(1.0)));
    vec3 place = float(across) - steps * lines.drift;
    const float EDGE = 1e-3;
    bvec3 on = lessThanEqual(abs(place - 0.5 * float(lines.last)),
                             vec3(0.5 * float(lines.last) + EDGE));
    vec3 near = mix(vec3(NO_HORIZON), (terrain - foot) / (steps * lines.run), on);
    return max(tangent, max(near.x, max(near.y, near.z)));
}
#endif
