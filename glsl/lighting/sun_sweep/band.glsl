// lighting/sun_sweep/band.glsl -- bands of terrain between parallel lines, and their horizons.
//
//   gives    Lines, lines_towards, slopes_around, POINT, CONE, DISC, Band, band_at, first_row,
//            last_row, enter_row, texel_of, horizon_of, NO_HORIZON
//   needs    nothing of its own; the texture of heights comes as an argument
//   units    rows and places in texels; heights and lengths in metres; tangents: rise over run
//   source   the upper hull of a line, as in V. Timonen and J. Westerholm 2010, "Scalable Height
//            Field Self-Shadowing" (Computer Graphics Forum 29), but only where it touches a few
//            slopes: derived here
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// Rows are counted from the sun's side, along the axis that the light follows more. A line is
// level with the light and moves by `drift` texels across the rows, each row. Two lines, a texel
// apart, bound a band, and each texel of a row lies in one band: on its first line or between.
//
// The points of a line that can be its horizon are the upper hull of those passed so far, and the
// horizon seen from a height is the hull point of the greatest tangent. Near that greatest tangent
// all tangents are nearly equal. So it is enough to keep, for a few slopes around the sun's own,
// the point at which a line of that slope rests on the hull: a fixed amount of work a row, and
// no stack. Horizons far above or below the sun come out too low; they are still on its side.
//
// A line passes between texels, and interpolation smooths its heights. Far off that hardly turns
// the horizon; close by it does. So the nearest rows are read along the texel's own way to the
// sun, as a march reads them, and the two lines give what lies beyond.
#ifndef LIGHTING_SUN_SWEEP_BAND
#define LIGHTING_SUN_SWEEP_BAND

// A tangent below all others: no terrain stands towards the sun.
const float NO_HORIZON = -10000.0;
const float NOWHERE = -1e30;  // metres

// Points so many rows away or more are the lines'; nearer ones are on the texel's own way.
const int NEAR_ROWS = 4;

struct Lines {
    bool along_x;    // rows are counted along x, not y
    bool from_high;  // the sun stands where x or y is greatest
    int rows;
    int last;        // texel of a row
    float drift;     // texels across, a row; -1..1
    float run;       // metres a row
};

Lines lines_towards(ivec2 grid, vec3 light, vec2 metres) {
    vec2 way = light.xy / metres;
    bool along_x = abs(way.x) >= abs(way.y);
    float ahead = along_x ? way.x : way.y;
    float aside = along_x ? way.y : way.x;
    float drift = ahead == 0.0 ? 0.0 : -aside / abs(ahead);
    // Along an axis and a diagonal a line meets texels only, which rounding would undo.
    if (abs(drift) < 1e-6) drift = 0.0;
    if (abs(abs(drift) - 1.0) < 1e-6) drift = sign(drift);
    vec2 row = along_x ? vec2(1.0, drift) : vec2(drift, 1.0);
    ivec2 turned = along_x ? grid : grid.yx;
    return Lines(along_x, ahead > 0.0, turned.x, turned.y - 1, drift, length(row * metres));
}

// What stands for the sun: a point, a cone around its ray, or a disc.
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

// For each of four slopes, the point of a line on which a line of that slope rests.
struct Casters {
    vec4 height;
    vec4 rows;  // how many rows ago
};

struct Band {
    int line;      // where its first line begins: so many texels across on row 0
    int row;       // the row that it has reached
    int across;    // the texel at or before the first line on it
    float part;    // of a texel from there to the line
    vec3 texels;   // the heights from there on, of three texels
    vec2 feet;     // the heights of both lines
    vec3 texels1;  // as above, one to three rows ago
    vec3 texels2;
    vec3 texels3;
    vec3 parts;
    vec2 feet1;    // one to four rows ago; NOWHERE beside the terrain
    vec2 feet2;
    vec2 feet3;
    vec2 feet4;
    Casters first;
    Casters second;
};

Band band_at(int line) {
    vec3 no_texels = vec3(NOWHERE);
    vec2 no_feet = vec2(NOWHERE);
    Casters none = Casters(vec4(NOWHERE), vec4(1.0));
    return Band(line, 0, 0, 0.0, no_texels, no_feet, no_texels, no_texels, no_texels, vec3(0.0),
                no_feet, no_feet, no_feet, no_feet, none, none);
}

// Texels that lines have moved across until a row, whole ones and the part of one.
int moved(Lines lines, int row) {
    return int(floor(float(row) * lines.drift));
}
float moved_part(Lines lines, int row) {
    float all = float(row) * lines.drift;
    return all - floor(all);
}

// The first row on which a band may hold texels, with those that are near it; and the row after
// the last.
int first_row(Lines lines, int line) {
    int start = lines.drift > 0.0 ? -1 : lines.last + 1;
    float entry = lines.drift == 0.0 ? 0.0 : float(start - line) / lines.drift;
    return max(int(clamp(entry, 0.0, 65000.0)) - NEAR_ROWS - 1, 0);
}
int last_row(Lines lines, int line) {
    int end = lines.drift > 0.0 ? lines.last + 1 : -1;
    float leave = lines.drift == 0.0 ? 65000.0 : float(end - line) / lines.drift;
    return min(int(clamp(leave, -2.0, 65000.0)) + 2, lines.rows);
}

// The texel of the terrain on a row.
ivec2 texel_on(Lines lines, int row, int across) {
    int ahead = lines.from_high ? lines.rows - 1 - row : row;
    return lines.along_x ? ivec2(ahead, across) : ivec2(across, ahead);
}

float height_across(sampler2D field, Lines lines, int row, int across) {
    return texelFetch(field, texel_on(lines, row, clamp(across, 0, lines.last)), 0).r;
}

Casters one_row_on(Casters casters, float height, vec4 climb) {
    vec4 rows = casters.rows + 1.0;
    bvec4 higher = greaterThanEqual(vec4(height),
                                    casters.height - climb * (rows - float(NEAR_ROWS)));
    return Casters(mix(casters.height, vec4(height), higher), mix(rows, vec4(NEAR_ROWS), higher));
}

// Enter the next row; height 1 is so many metres.
void enter_row(inout Band band, sampler2D field, Lines lines, int row, vec4 climb, float metres) {
    // The points that are now NEAR_ROWS back count from here.
    band.first = one_row_on(band.first, band.feet4.x, climb);
    band.second = one_row_on(band.second, band.feet4.y, climb);
    band.texels3 = band.texels2;
    band.texels2 = band.texels1;
    band.texels1 = band.texels;
    band.parts = vec3(band.part, band.parts.xy);
    band.row = row;
    band.across = band.line + moved(lines, row);
    band.part = moved_part(lines, row);
    band.texels = metres * vec3(
        height_across(field, lines, row, band.across),
        height_across(field, lines, row, band.across + 1),
        height_across(field, lines, row, band.across + 2)
    );
    band.feet = band.texels.xy + (band.texels.yz - band.texels.xy) * band.part;
    // Beside the terrain a line has a foot, on the terrain's edge, but throws no shadow.
    int beyond = lines.last - (band.part > 0.0 ? 1 : 0);
    band.feet4 = band.feet3;
    band.feet3 = band.feet2;
    band.feet2 = band.feet1;
    band.feet1 = vec2(
        band.across < 0 || band.across > beyond ? NOWHERE : band.feet.x,
        band.across < -1 || band.across >= beyond ? NOWHERE : band.feet.y
    );
}

// The band's texel on the row that it has reached: across the row, perhaps beside the terrain.
int texel_of(Band band) {
    return band.across + (band.part > 0.0 ? 1 : 0);
}

float tangent_over(Casters casters, float height, float run) {
    vec4 tangent = (casters.height - height) / (casters.rows * run);
    return max(max(max(tangent.x, tangent.y), max(tangent.z, tangent.w)), NO_HORIZON);
}

// The rise from a height to what the texel's own way meets some rows before: `lead` texels after
// the first line.
float near_rise(vec3 texels, float part, float lead, float foot) {
    float at = part + lead;
    float land = at < 1.0 ? texels.x + (texels.y - texels.x) * at
            : texels.y + (texels.z - texels.y) * (at - 1.0);
    return land - foot;
}

// The horizon's tangent, from the texel on the row that the band has reached.
float horizon_of(Band band, Lines lines) {
    bool between = band.part > 0.0;
    float lead = between ? 1.0 - band.part : 0.0;
    float one = tangent_over(band.first, band.feet.x, lines.run);
    float two = tangent_over(band.second, band.feet.y, lines.run);
    // A line that has met no terrain says nothing of what lies beside it.
    if (between && one <= NO_HORIZON) one = two;
    if (two <= NO_HORIZON) two = one;
    float tangent = one + (two - one) * lead;
    float foot = between ? band.texels.y : band.texels.x;
    vec3 rise = vec3(
        near_rise(band.texels1, band.parts.x, lead, foot),
        near_rise(band.texels2, band.parts.y, lead, foot),
        near_rise(band.texels3, band.parts.z, lead, foot)
    );
    // The way leaves the terrain at its sides; rows before the first are nowhere already.
    vec3 steps = vec3(1.0, 2.0, 3.0);
    vec3 place = float(texel_of(band)) - steps * lines.drift;
    vec3 near = rise / (steps * lines.run);
    const float EDGE = 1e-3;
    bvec3 off = bvec3(
        place.x < -EDGE || place.x > float(lines.last) + EDGE,
        place.y < -EDGE || place.y > float(lines.last) + EDGE,
        place.z < -EDGE || place.z > float(lines.last) + EDGE
    );
    near = mix(near, vec3(NO_HORIZON), off);
    return max(tangent, max(near.x, max(near.y, near.z)));
}
#endif
