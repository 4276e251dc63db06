// view/profile/plot.glsl -- the heights under a line: a map with the line, and a section.
//
//   gives    frame, display-encoded
//   needs    colour/encode.glsl, maths/segment.glsl, terrain/heightfield.glsl,
//            view/profile/digits.glsl; a height, the lowest and the highest elevation under the
//            line; a colour and a light if there are
//   units    elevations in metres above sea level, distances along the line in metres, or in
//            kilometres from 10 km up; widths in pixels
//   source   none: a picture of numbers. A pixel is covered by how far it is from the curve
//   tested   tests/glsl/test_view_profile.py, by where curve, ticks and numbers must be
//
// The line begins at the disc and ends at the ring, on the map and under the section. Ticks
// are at 1, 2 or 5 times a power of ten.
#include "colour/encode.glsl"
#include "maths/segment.glsl"
#include "terrain/heightfield.glsl"
#include "view/profile/digits.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D height;  //! input
uniform sampler2D range;   //! input
uniform sampler2D colour;  //! input("linear", "mipmap", "white")
uniform sampler2D light;   //! input("linear", "mipmap", "white")

#include "view/parameters/profile_line.glsl"
uniform int elevations = 0;            //! menu("of the line", "of the land") group("Section")
                                       //! Which elevations the section has room for
uniform float width = 2.0;             //! slider(0.5, 8) step(0.1) unit("pixels") group("Section")
                                       //! Of the curve
uniform vec3 curve = vec3(0.35, 0.03, 0.02);    //! colour group("Colours")
                                                //! The curve, and the line on the map
uniform vec3 ground = vec3(0.60, 0.50, 0.36);   //! colour group("Colours") Below the curve
uniform vec3 paper = vec3(1.0);                 //! colour group("Colours") Behind it all
uniform vec3 ink = vec3(0.03);                  //! colour group("Colours") Axes and numbers
uniform vec3 rule = vec3(0.72);                 //! colour group("Colours") Lines at the ticks

// How large things are, in pixels; places from the picture's lower left corner.
struct Layout {
    int dot_size;  // of a dot of a number
    vec4 map;      // west, south, width, height
    vec4 plot;
};

Layout arranged() {
    int s = max(1, size.y / 300);
    float margin = 12.0 * float(s);
    float room = min(float(size.y) - 2.0 * margin, 0.36 * (float(size.x) - 3.0 * margin));
    vec2 land = floor(room * extent / max(extent.x, extent.y));
    vec4 map = vec4(margin, floor(0.5 * (float(size.y) - land.y)), land);
    vec2 corner = vec2(margin + floor(room) + margin + 32.0 * float(s), margin + 16.0 * float(s));
    vec2 sides = vec2(float(size.x) - 1.5 * margin, float(size.y) - margin - 12.0 * float(s))
            - corner;
    return Layout(s, map, vec4(corner, max(sides, vec2(1.0))));
}

// 1, 2 or 5 times a power of ten, so that no more than `maximum` steps fit into a span.
float step_for(float span, float maximum) {
    float needed = span / max(maximum, 1.0);
    float found = 1e9;
    for (int power = 8; power >= -3; power--) {
        float decade = 1.0;
        for (int k = 0; k < abs(power); k++) decade *= 10.0;
        if (power < 0) decade = 1.0 / decade;
        if (5.0 * decade >= needed) found = 5.0 * decade;
        if (2.0 * decade >= needed) found = 2.0 * decade;
        if (decade >= needed) found = decade;
    }
    return found;
}

int decimals_of(float by) {
    return by >= 0.99 ? 0 : by >= 0.099 ? 1 : by >= 0.0099 ? 2 : 3;
}

// The k-th tick as a whole number with that many decimals.
int label_of(float k, float by, int decimals) {
    float tens = decimals == 0 ? 1.0 : decimals == 1 ? 10.0 : decimals == 2 ? 100.0 : 1000.0;
    return int(floor(k * by * tens + 0.5));
}

float cover(float far, float wide) {
    return clamp(0.5 * wide + 0.5 - far, 0.0, 1.0) * min(wide, 1.0);
}

// A disc, or a ring: the line's two ends.
float mark(vec2 offset, float radius, bool hollow) {
    float far = length(offset);
    float disc = clamp(radius + 0.5 - far, 0.0, 1.0);
    return hollow ? disc * clamp(far - 0.5 * radius + 0.5, 0.0, 1.0) : disc;
}

float elevation_at(float along) {
    vec2 share = mix(start, finish, along);
    return base_elevation + relief * height_at(height, share * vec2(textureSize(height, 0) - 1));
}

vec3 mean_at(sampler2D image, vec2 share, float side) {
    vec2 texels = vec2(textureSize(image, 0));
    float level = max(log2(texels.x / max(side, 1.0)), 0.0);
    return textureLod(image, (share * (texels - 1.0) + 0.5) / texels, level).rgb;
}

vec3 map_at(vec2 share, float side) {
    vec2 grid = vec2(textureSize(height, 0) - 1);
    if (textureSize(colour, 0).x > 1) {
        return mean_at(colour, share, side) * mean_at(light, share, side);
    }
    // Without a colour: greys by height, lit from the north-west.
    vec2 slope = relief * slope_at(height, share * grid, spacing_of(ivec2(grid) + 1, extent),
                                   CENTRAL_DIFFERENCES);
    vec3 normal = normalize(vec3(-slope, 1.0));
    float lit = max(dot(normal, normalize(vec3(-1.0, 1.0, 1.4))), 0.0);
    return vec3(mix(0.12, 0.85, clamp(height_at(height, share * grid), 0.0, 1.0))
                * (0.3 + 0.9 * lit));
}

vec4 kernel(ivec2 texel) {
    Layout at = arranged();
    float s = float(at.dot_size);
    vec2 place = vec2(texel) + 0.5;
    vec3 seen = paper;

    // The map, north on top.
    vec2 share = (place - at.map.xy) / at.map.zw;
    vec2 begins = at.map.xy + start * at.map.zw;
    vec2 ends = at.map.xy + finish * at.map.zw;
    if (all(greaterThanEqual(share, vec2(0.0))) && all(lessThanEqual(share, vec2(1.0)))) {
        seen = map_at(share, at.map.z);
    }
    float line = distance_to_segment(place, begins, ends);
    seen = mix(seen, vec3(1.0), 0.8 * cover(line, width + 2.0 * s));
    seen = mix(seen, curve, cover(line, width));
    seen = mix(seen, vec3(1.0), mark(place - begins, 5.0 * s, false)
               + mark(place - ends, 5.0 * s, false));
    seen = mix(seen, curve, mark(place - begins, 4.0 * s, false));
    seen = mix(seen, curve, mark(place - ends, 4.0 * s, true));

    // The section: elevations from low to high, distances from 0.
    vec2 found = elevations == 1 ? base_elevation + vec2(0.0, relief)
            : texelFetch(range, ivec2(0), 0).rg;
    float span = max(found.y - found.x, 1e-2);
    float low = found.x - 0.06 * span;
    float high = found.y + 0.06 * span + (found.y - found.x < 1e-2 ? 1e-2 : 0.0);
    float rise = at.plot.w / (high - low);
    float total = max(length((finish - start) * extent), 1e-3);
    float unit = total >= 10000.0 ? 1000.0 : 1.0;
    float up_by = step_for(high - low, at.plot.w / (26.0 * s));
    float along_by = step_for(total / unit, at.plot.z / (56.0 * s));
    float along_pixels = at.plot.z / total * unit * along_by;

    vec2 in_plot = place - at.plot.xy;
    float up_tick = floor((low + in_plot.y / rise) / up_by + 0.5);
    float up_at = (up_tick * up_by - low) * rise;
    bool up_shown = up_at >= 0.0 && up_at <= at.plot.w;
    float along_tick = max(floor(in_plot.x / along_pixels + 0.5), 0.0);
    float along_at = along_tick * along_pixels;
    bool along_shown = along_at <= at.plot.z + 0.5;
    if (all(greaterThanEqual(in_plot, vec2(0.0))) && all(lessThan(in_plot, at.plot.zw))) {
        if (up_shown) seen = mix(seen, rule, cover(abs(in_plot.y - up_at), s));
        if (along_shown) seen = mix(seen, rule, cover(abs(in_plot.x - along_at), s));
        float nearest = 1e9;
        vec2 from = vec2(0.0);
        const int REACH = 3;
        for (int k = -REACH; k <= REACH; k++) {
            float x = clamp(in_plot.x + float(k), 0.0, at.plot.z);
            vec2 to = vec2(x, clamp((elevation_at(x / at.plot.z) - low) * rise, -1e5, 1e5));
            if (k > -REACH) nearest = min(nearest, distance_to_segment(in_plot, from, to));
            if (k == 0 && in_plot.y < to.y) seen = mix(seen, ground, 0.55);
            from = to;
        }
        seen = mix(seen, curve, cover(nearest, width));
    }
    // Axes, ticks outside of them, numbers next to the ticks.
    if (in_plot.y >= -5.0 * s && in_plot.y < at.plot.w && in_plot.x >= -5.0 * s
        && in_plot.x < at.plot.z + s) {
        bool axis = (abs(in_plot.x) < 0.5 * s + 0.01 && in_plot.y > -s)
                || (abs(in_plot.y) < 0.5 * s + 0.01 && in_plot.x > -s);
        bool up_ticks = up_shown && in_plot.x < 0.0 && abs(in_plot.y - up_at) < 0.5 * s + 0.01;
        bool along_ticks = along_shown && in_plot.y < 0.0
                && abs(in_plot.x - along_at) < 0.5 * s + 0.01;
        if (axis || up_ticks || along_ticks) seen = ink;
    }
    float written = 0.0;
    ivec2 origin = ivec2(at.plot.xy);
    int decimals = decimals_of(up_by);
    int number = label_of(up_tick, up_by, decimals);
    ivec2 corner = origin + ivec2(-7 * at.dot_size - number_width(number, decimals) * at.dot_size,
                                  int(floor(up_at)) - 3 * at.dot_size);
    ivec2 from_corner = texel - corner;
    if (up_shown && in_plot.x < 0.0) {
        written += number_at(ivec2(floor(vec2(from_corner) / s)), number, decimals);
    }
    decimals = decimals_of(along_by);
    number = label_of(along_tick, along_by, decimals);
    corner = origin + ivec2(int(floor(along_at))
                            - number_width(number, decimals) * at.dot_size / 2, -15 * at.dot_size);
    from_corner = texel - corner;
    if (along_shown && in_plot.y < 0.0) {
        written += number_at(ivec2(floor(vec2(from_corner) / s)), number, decimals);
    }
    // Units: metres over the one axis, metres or kilometres at the end of the other.
    ivec2 dot_of = ivec2(floor(vec2(texel - origin
                                    - ivec2(-8 * at.dot_size, int(at.plot.w) + 4 * at.dot_size))
                                    / s));
    written += sign_at(SIGN_METRES, dot_of);
    dot_of = ivec2(floor(vec2(texel - origin
                              - ivec2(int(at.plot.z) - at.dot_size, 4 * at.dot_size)) / s));
    written += sign_at(SIGN_METRES, dot_of);
    if (unit > 1.0) written += sign_at(SIGN_KILO, dot_of + ivec2(SIGN_ADVANCE, 0));
    seen = mix(seen, ink, min(written, 1.0));
    seen = mix(seen, curve, mark(in_plot, 3.0 * s, false));
    vec2 last = in_plot - vec2(at.plot.z, 0.0);
    seen = mix(seen, paper, mark(last, 3.0 * s, false));
    seen = mix(seen, curve, mark(last, 3.0 * s, true));
    return vec4(srgb_from_linear(seen), 1.0);
}
