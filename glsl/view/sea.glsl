// view/sea.glsl -- a flat sea over the terrain that lies below its level.
//
//   gives    frame, linear light, over an earlier frame
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, terrain/heightfield.glsl;
//            a height 0..1; a frame with its depth to start from
//   units    metres; colours linear
//   source   Fresnel's reflection by Schlick 1994, "An Inexpensive BRDF Model for
//            Physically-based Rendering", with 0.02 for water; light lost exponentially with depth
//   tested   tests/glsl/test_view.py: drowns the terrain below its level and no other
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "terrain/heightfield.glsl"
#pragma draw(mesh = "sheet", output = "frame:rgba16f", blend = "alpha", level = "sea_level", \
             repeat = "1 if sea else 0")

uniform sampler2D height;  //! input
uniform sampler2D daylight;  //! input("black")

uniform bool sea = false;               //! group("Sea") Draw the sea
uniform float sea_level = 0.0;          //! slider(-500, 9000) step(1) unit("m") group("Sea")
                                        //! Height of its surface, as elevations are counted
uniform vec3 water = vec3(0.015, 0.075, 0.11);  //! colour group("Sea") Deep water
uniform float clarity = 12.0;           //! log_slider(0.1, 500) unit("m") group("Sea")
                                        //! Depth through which a third of the light comes back
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);  //! colour group("Sky") What it mirrors
uniform int sky = 0;  //! menu("colours", "daylight") group("Sky")
                      //! Whether it mirrors that colour, or the sky of lighting/daylight

const float BURIED = 0.05;  // more than the mesh differs from the heights at a shore

vec4 vertex(vec3 corner, out vec3 position) {
    position = vec3(corner.xy * extent, sea_level - base_elevation);
    return clip_from_world * vec4(position, 1.0);
}

vec4 fragment(vec3 position) {
    vec2 share = position.xy / extent;
    float ground = height_at(height, share * vec2(textureSize(height, 0) - 1)) * relief;
    // Far below the ground it cannot be seen, unless it floats in the air below the whole terrain.
    if (ground - position.z > BURIED * relief) discard;
    float depth = max(position.z - ground, 0.0);
    float facing = abs(normalize(eye - position).z);
    float mirrored = 0.02 + 0.98 * pow(1.0 - facing, 5.0);
    // Even a film of water darkens the ground, and shows where the shore is.
    float hidden = 1.0 - 0.6 * exp(-depth / clarity);
    vec3 below = water;
    vec3 above = horizon;
    if (sky == 1 && wired_daylight) {
        vec3 direction = normalize(position - eye);
        above = sky_towards(daylight, vec3(direction.xy, abs(direction.z)), 0.001 * sea_level);
        below *= level_light(daylight);
    }
    return vec4(mix(below, above, mirrored), mix(hidden, 1.0, mirrored));
}
