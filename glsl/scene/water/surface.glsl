// scene/water/surface.glsl -- the picture with its water: mirrored, seen through, glittering.
//
//   gives    frame, linear light
//   needs    clouds/shadow.glsl, lighting/daylight_reading.glsl, lighting/daylight_sky.glsl,
//            lighting/sun.glsl, lighting/sun_image.glsl, noise/gradient.glsl,
//            scene/air_reading.glsl, scene/footprint.glsl, scene/ground_reading.glsl,
//            scene/surfaces.glsl, scene/water/, view/surface.glsl, water/body.glsl,
//            water/foam.glsl, water/rough_mirror.glsl, water/waves.glsl; the picture without
//            water, what scene/water/where gives, the ground and the maps that scene/shaded has
//   units    metres; light without unit, 1 for white
//   source   each part in its own file
//   tested   tests/glsl/test_scene_water.py
//
//     frame = air(sum over mirrors of F L  +  (1 - F) (bed e^-c path + sent back)  +  glint)
//
// What the bed shows is in the picture already; the rest of it goes on as it is. What is mirrored
// is chosen first and lit once: the sky of scene/water/heaven with clouds, or the terrain, by the
// maps of its colour and of its light. All is read at the pixel's own place.
#include "clouds/shadow.glsl"
#include "lighting/daylight_reading.glsl"
#include "lighting/daylight_sky.glsl"
#include "lighting/sun.glsl"
#include "lighting/sun_image.glsl"
#include "noise/gradient.glsl"
#include "scene/air_reading.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "scene/water/mirrored.glsl"
#include "scene/water/mirrored_sky.glsl"
#include "scene/water/moment_texels.glsl"
#include "scene/water/ripples.glsl"
#include "scene/water/shore.glsl"
#include "view/surface.glsl"
#include "water/body.glsl"
#include "water/foam.glsl"
#include "water/rough_mirror.glsl"
#include "water/waves.glsl"
#pragma kernel(output = "frame:rgba16f")

uniform sampler2D picture;       //! input
uniform sampler2D seen_water;    //! input
uniform sampler2D state;         //! input
uniform sampler2D height;        //! input
uniform sampler2D block_maxima;  //! input
uniform sampler2D ground;        //! input("linear", "mipmap")
uniform sampler2D colour;        //! input("linear", "mipmap", "white")
uniform sampler2D weights;       //! input("linear", "mipmap", "white")
uniform sampler2D density;       //! input("zero")
uniform sampler2D moment;        //! input
uniform sampler2D heaven;        //! input("linear", "repeat")
uniform sampler2D cloud;         //! input("linear", "repeat", "mipmap", "white")
uniform sampler2D scattered;     //! input("linear", "black")
uniform sampler2D left;          //! input("linear", "black")
#include "clouds/parameters/drawn.glsl"
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "view/parameters/haze.glsl"
#include "water/parameters/wind.glsl"

uniform float gusts = 0.5;        //! slider(0, 1) step(0.01) group("Water")
                                  //! How unevenly it blows, in patches
uniform float clarity = 3.0;      //! log_slider(0.05, 18) unit("m") group("Water")
                                  //! Depth at which a third of the green light is left
uniform vec3 deep = vec3(0.008, 0.018, 0.016);  //! colour group("Water")
                                  //! What deep water sends back of white light
uniform float foam = 1.0;         //! slider(0, 2) step(0.01) group("Water")
                                  //! Foam at the shore, on crests and in rapids
uniform float tallest = 21.0;     //! log_slider(0.1, 100) unit("m") group("Water")
                                  //! Trees that it mirrors, where a density is wired

const uint SALT = 0xaa77626du;    // CRC-32 of "scene/water/surface"
const float MOVING = 0.05;        // [m/s] slower water has the waves of a lake

// A piece of water, or of ground above it, that a pixel shows.
struct Surface {
    vec3 point;
    float eye_distance;
    vec3 to_eye;
    float pixel;      // how wide one is  [radians]
    Footprint foot;   // on level ground
    Ground ground;    // below
    float depth;      // of the water; below 0 for ground above it
    vec2 current;
    float white;      // how white it runs
    Aerial air;       // in front of it
};

// The light that falls on it.
struct Lit {
    Sunlight from;
    vec3 beam;   // of the sun on what faces it, under the clouds and the terrain's shadow
    vec3 level;  // of the sun on the level surface
    vec3 sky;
};

Surface surface_at(ivec2 texel, vec3 point, vec4 water);
Lit light_on(Surface surface);
vec3 mirrored_light(Surface surface, Mirrors mirrors, Ripples ripples, Lit lit);
vec3 glint_of_sun(Surface surface, Mirrors mirrors, Ripples ripples, Lit lit);
vec3 light_from_below(Surface surface, vec3 shown, Lit lit);
float foam_on(Surface surface, Ripples ripples, Sea sea, float gust);

vec4 kernel(ivec2 texel) {
    vec4 shown = texelFetch(picture, texel, 0);
    vec4 at = texelFetch(seen_water, texel, 0);
    vec4 water = texelFetch(state, texel, 0);
    vec2 downwind = vec2(sin(radians(wind_to)), cos(radians(wind_to)));
    Sea sea = sea_of(wind, fetch, downwind);
    bool near_shore = is_top(at.w) && -water.x <= run_up(sea);
    if (!is_water(at.w) && !near_shore) return shown;
    if (skips_rest()) return vec4(0.0);
    Surface surface = surface_at(texel, at.xyz, water);
    if (!is_water(at.w)) {
        float pixel = surface.eye_distance * surface.pixel;
        float wet = wet_share(sea, -surface.depth, length(surface.ground.slope), pixel);
        return vec4(shown.rgb - wet * max(shown.rgb - surface.air.scattered, 0.0), shown.a);
    }
    Lit lit = light_on(surface);
    vec2 place = surface.point.xy;
    float gust = gust_at(place, wind * downwind, gusts, time, sea.longest,
                         surface.eye_distance * surface.pixel, SALT);
    Ripples ripples;
    if (length(surface.current) > MOVING) {
        ripples = ripples_of_current(moment, surface.current, surface.white, place, time,
                                     surface.foot);
    } else {
        ripples = ripples_of_wind(moment, sea, gust, place, time, surface.foot);
    }
    Mirrors mirrors = mirrors_of(surface.to_eye, ripples.waves.slope, ripples.waves.variance);
    vec3 above = mirrored_light(surface, mirrors, ripples, lit)
            + glint_of_sun(surface, mirrors, ripples, lit);
    vec3 light = above + (1.0 - mirrors.mirrored) * light_from_below(surface, shown.rgb, lit);
    light = mix(light, FOAM_ALBEDO * (lit.level + lit.sky),
                foam_on(surface, ripples, sea, gust));
    return vec4(light * surface.air.left + surface.air.scattered, 1.0);
}

// The air between the eye and what lies so far away at a place of the picture, 0..1.
Aerial air_before(vec2 share, float eye_distance) {
    if (wired_scattered && wired_left) return aerial(scattered, left, share, eye_distance);
    vec3 air = wired_daylight ? horizon_of(daylight, 0.001 * (base_elevation + eye.z)) : horizon;
    float clean = exp(-haze * eye_distance / max(extent.x, extent.y));
    return Aerial(air * (1.0 - clean), vec3(clean));
}

Surface surface_at(ivec2 texel, vec3 point, vec4 water) {
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    Surface surface;
    surface.point = point;
    surface.eye_distance = distance(eye, point);
    surface.to_eye = (eye - point) / surface.eye_distance;
    surface.pixel = length(ray.up) / length(ray.ahead);
    surface.foot = footprint_of(ray, point - eye, vec3(0.0, 0.0, 1.0));
    surface.ground = ground_at(ground, point.xy, extent, surface.eye_distance * surface.pixel);
    surface.depth = water.x;
    surface.current = water.yz;
    surface.white = water.w;
    surface.air = air_before((vec2(texel) + 0.5) / vec2(size), surface.eye_distance);
    return surface;
}

float cloud_shade(vec3 point, vec3 to_light) {
    vec4 drift = texelFetch(moment, DRIFT, 0);
    if (!wired_cloud || clouds == 0 || drift.w <= 0.0) return 1.0;
    return wired_daylight ? cloud_share(cloud, drift, point, to_light)
            : cloud_transmittance(cloud, drift, point, to_light);
}

Lit light_on(Surface surface) {
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    vec3 beam = from.sun * (gain * cloud_shade(surface.point, from.direction));
    if (from.direction.z <= 0.0) beam = vec3(0.0);
    return Lit(from, beam, beam * (surface.ground.sun * max(from.direction.z, 0.0)),
               from.sky * (ambient * surface.ground.sky));
}

float density_at(vec2 share) {
    return height_at(density, clamp(share, 0.0, 1.0) * vec2(textureSize(density, 0) - 1));
}

float wood_height(vec2 share) {
    return tallest * 0.85 * smoothstep(0.1, 0.6, density_at(share));
}

// The distance to the terrain or its woods, or MISSES.
float distance_to_terrain(vec3 point, vec3 direction) {
    return meets_terrain(height, block_maxima, point, direction, extent, relief,
                         wired_density ? tallest : 0.0);
}

// The terrain's own colour there, of a texture or of four tiles by their means.
vec3 colour_of_terrain(vec2 share, float wide) {
    if (!wired_colour && !wired_weights) return vec3(0.4);
    ivec2 texels = wired_weights ? textureSize(weights, 0) : textureSize(colour, 0);
    vec2 texels_wide = wide * vec2(texels - 1) / extent;
    float level = log2(max(max(texels_wide.x, texels_wide.y), 1e-3));
    vec2 at = drape_uv(share, texels);
    if (!wired_weights) return textureLod(colour, at, level).rgb;
    vec4 weight = textureLod(weights, at, level);
    vec3 total = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        total += weight[k] * texelFetch(moment, TILES + ivec2(k, 0), 0).rgb;
    }
    return total / max(weight.x + weight.y + weight.z + weight.w, 1e-3);
}

// Light of the terrain where a mirrored ray meets it, `wide` metres of which are a pixel's.
vec3 light_of_terrain(vec3 point, vec3 to_ray, float wide, Sunlight from) {
    vec2 share = point.xy / extent;
    Ground around = ground_at(ground, point.xy, extent, wide);
    vec3 albedo = colour_of_terrain(share, wide);
    vec3 normal = normal_of_slope(around.slope);
    // Rocks and crowns are lighter and darker than their mean.
    float shown = clamp(14.0 / wide - 1.0, 0.0, 1.0);
    float lump = shown * perlin(point.xy / 14.0 + point.z / 9.0, SALT + 3u).x;
    float wood = smoothstep(0.1, 0.6, density_at(share));
    albedo = mix((1.0 + 0.35 * lump) * albedo,
                 (1.0 + 0.6 * lump) * texelFetch(moment, WOOD, 0).rgb, wood);
    // Crowns are spheres, of which the ray sees the lit side or the other (Lambert's sphere).
    float phase = acos(clamp(dot(to_ray, from.direction), -1.0, 1.0));
    float crown = 2.0 / 3.0 * (sin(phase) + (3.14159265 - phase) * cos(phase)) / 3.14159265;
    float facing = mix(max(dot(normal, from.direction), 0.0), 0.85 * crown, wood);
    if (from.direction.z < 0.0) facing = 0.0;
    float direct = gain * around.sun * facing * cloud_shade(point, from.direction);
    float open = ambient * around.sky * mix(1.0, 0.6, wood);
    return albedo * (from.sun * direct + from.sky * open);
}

// What the mirrors have of the sky, and of the terrain, at the mean of where they meet it.
vec3 mirrored_light(Surface surface, Mirrors mirrors, Ripples ripples, Lit lit) {
    vec3 light = vec3(0.0);
    vec3 mean = vec3(0.0);
    vec4 met = vec4(0.0);
    for (int k = 0; k < MIRRORS; k++) {
        vec3 to = mirrors.to[k];
        mean += mirrors.share[k] * to;
        vec3 risen = normalize(vec3(to.xy, length(vec2(to.z, ripples.lowest))));
        float run = distance_to_terrain(surface.point, risen);
        if (run < 0.0) light += mirrors.share[k] * sky_of(heaven, CLEAR_SKY, to);
        else met += mirrors.share[k] * vec4(run * risen, 1.0);
    }
    vec4 drift = texelFetch(moment, DRIFT, 0);
    if (clouds != 0 && wired_cloud && drift.w > 0.0) {
        float blur = LOBE * sqrt(ripples.waves.variance) + surface.pixel;
        vec4 layer = clouds_towards(cloud, heaven, drift, surface.point, normalize(mean), blur,
                                    clouds == 2);
        light = light * layer.a + max(mirrors.mirrored - met.w, 0.0) * layer.rgb;
    }
    if (met.w <= 0.0) return light;
    vec3 hit = surface.point + met.xyz / met.w;
    float run = distance(surface.point, hit);
    float eye_distance = surface.eye_distance + run;
    vec3 terrain = light_of_terrain(hit, (surface.point - hit) / max(run, 1e-3),
                                    eye_distance * surface.pixel, lit.from);
    // Seen straight from the eye the air before it is about that along the mirrored path.
    vec4 clip = clip_from_world * vec4(hit, 1.0);
    vec2 share = clip.w > 0.0 ? clip.xy / clip.w * 0.5 + 0.5 : vec2(0.5);
    Aerial air = air_before(clamp(share, 0.0, 1.0), eye_distance);
    vec3 added = max(air.scattered - surface.air.scattered, 0.0);
    return light + met.w * (terrain * air.left + added) / max(surface.air.left, 1e-3);
}

vec3 glint_of_sun(Surface surface, Mirrors mirrors, Ripples ripples, Lit lit) {
    float glint = sun_glint(surface.to_eye, lit.from.direction, ripples.waves.slope,
                            ripples.waves.variance, mirrors.area);
    if (glint <= 1e-3) return vec3(0.0);
    bool hidden = distance_to_terrain(surface.point, lit.from.direction) >= 0.0;
    return sun_image(lit.beam, hidden ? 0.0 : glint);
}

// Where there is no bed it is too deep for any of what is shown there.
vec3 light_from_below(Surface surface, vec3 shown, Lit lit) {
    vec3 bed = max(shown - surface.air.scattered, 0.0) / max(surface.air.left, 1e-3);
    float path = path_in_water(surface.depth, lit.from.direction.z, surface.to_eye.z);
    vec3 passed = light_left(attenuation_of(clarity), path);
    vec3 down = light_down(lit.level, lit.sky, lit.from.direction.z);
    vec3 on_bed = max(lit.level + lit.sky, 1e-6);
    return bed * (down / on_bed) * passed + deep * down * (1.0 - passed);
}

float foam_on(Surface surface, Ripples ripples, Sea sea, float gust) {
    vec2 place = surface.point.xy;
    float pixel = surface.eye_distance * surface.pixel;
    float cover = 0.0;
    if (all(lessThanEqual(abs(place / extent - 0.5), vec2(0.5)))) {
        vec2 at = place / extent * vec2(textureSize(height, 0) - 1);
        float depth = max(surface.point.z - relief * height_at(height, at), 0.0);
        cover = foam_at_shore(place, depth, surface.ground.slope, surface.foot, pixel, sea, gust,
                              time, SALT + 4u);
    }
    cover += whitecap_cover(wind * sqrt(gust)) + surface.white;
    // Whitecaps lie across the wind, and are drawn out along it.
    vec2 along = place - time * surface.current;
    along -= sea.towards * (0.6 * dot(along, sea.towards) + 0.5 * wind * time);
    return foam_of(clamp(foam * cover, 0.0, 1.0), along, ripples.lump, pixel);
}
