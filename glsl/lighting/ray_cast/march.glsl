// lighting/ray_cast/march.glsl -- light where a walk towards the sun meets no land, none elsewhere.
//
//   gives    light: red, green, blue; alpha the visible part of the sun, 0 or 1
//   needs    lighting/sun.glsl, terrain/heightfield.glsl; the range of the heights as an input
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_lighting.py, against a march in NumPy and walls' shadows in metres
//
// From each texel's own height a ray goes to the sun, a step at a time. Land above the ray
// hides the sun; a ray above the highest height, or off the land, is free. A surface turned
// away from the sun is dark without a walk.
//
// Mended: the thesis reads the texel that the ray's place is cut down to, which moves every
// shadow half a texel to the south-west; here heights are interpolated between texels' centres,
// and the land ends at the last one. Its way remains a choice, for comparison.
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                //! input
uniform sampler2D range;                 //! input
uniform vec2 sun = vec2(135.0, 25.0);    //! direction group("Sun") Azimuth clockwise from north, elevation above the horizon
uniform vec3 sun_colour = vec3(1.0);     //! colour group("Sun") Colour of the sun's light
uniform float gain = 2.0;                //! slider(0, 4) step(0.05) group("Sun") The sun's light is multiplied by it
uniform vec3 sky_colour = vec3(1.0);     //! colour group("Sky") Colour of the light from everywhere
uniform float ambient = 0.0;             //! slider(0, 1) step(0.01) group("Sky") Light from everywhere, in shadow too
uniform int normal = 0;                  //! menu("central differences", "one triangle") How the slope is found; the thesis takes one triangle, to one side
uniform float stride = 1.0;              //! slider(0.25, 4) step(0.25) group("March") unit("texels") Length of a step, along the axis that the ray follows more. Long steps jump over ridges
uniform int reading = 0;                 //! menu("interpolated", "cut down") group("March") Heights between texels, or of the texel that a place is cut down to, as in the thesis

// Steps until a place leaves 0..last along one axis.
float steps_inside(float place, float ahead, float last) {
    if (ahead == 0.0) return 1e9;
    return (ahead > 0.0 ? last - place : place) / abs(ahead);
}

// 1 if a ray from a place, `foot` metres high, towards the sun meets no land, else 0.
float seen(vec2 start, float foot, vec3 light, vec2 metres) {
    float level = length(light.xy);
    // A ray straight up leaves its texel nowhere.
    if (level < 1e-6) return 1.0;
    vec2 way = light.xy / metres;
    float longer = max(abs(way.x), abs(way.y));
    bool along_x = abs(way.x) == longer;
    // Whole texels along the longer axis must stay whole, which division does not promise on every GPU.
    vec2 ahead = stride * vec2(along_x ? sign(way.x) : way.x / longer, along_x ? way.y / longer : sign(way.y));
    float climb = stride * light.z / longer;
    vec2 last = vec2(textureSize(height, 0) - 1);
    float highest = texelFetch(range, ivec2(0), 0).g * relief;
    float steps = min(steps_inside(start.x, ahead.x, last.x), steps_inside(start.y, ahead.y, last.y));
    if (climb > 0.0) steps = min(steps, (highest - foot) / climb);
    // A step that ends on the edge counts as inside, whatever the rounding.
    int count = int(min(steps + 1e-3, 65000.0));
    // From a texel in whole steps, every place is on a line of texels.
    bool on_lines = size == textureSize(height, 0) && floor(stride) == stride;
    ivec2 across = along_x ? ivec2(0, 1) : ivec2(1, 0);
    if (reading == 0 && on_lines) {
        for (int k = 1; k <= count; k++) {
            float t = float(k);
            if (height_on_line(height, start + t * ahead, across) * relief > foot + t * climb) return 0.0;
        }
    } else if (reading == 0) {
        for (int k = 1; k <= count; k++) {
            float t = float(k);
            if (height_at(height, start + t * ahead) * relief > foot + t * climb) return 0.0;
        }
    } else {
        for (int k = 1; k <= count; k++) {
            float t = float(k);
            ivec2 cut = ivec2(clamp(start + t * ahead, vec2(0.0), last));
            if (texelFetch(height, cut, 0).r * relief > foot + t * climb) return 0.0;
        }
    }
    return 1.0;
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    vec2 metres = spacing_of(grid, extent);
    vec3 light = to_sun(sun);
    vec2 slope = relief * slope_at(height, place, metres, normal);
    float received = sun_on(normal_of_slope(slope), light);
    float visible = received > 0.0 ? seen(place, height_at(height, place) * relief, light, metres) : 0.0;
    return vec4(sun_colour * (visible * gain * received) + sky_colour * ambient, visible);
}
