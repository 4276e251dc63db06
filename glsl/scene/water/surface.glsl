// scene/water/surface.glsl -- the picture with its water: mirrored, seen through, glittering.
//
//   gives    frame, linear light
//   needs    clouds/shadow.glsl, lighting/daylight_reading.glsl, lighting/daylight_sky.glsl,
//            lighting/sun.glsl, lighting/sun_image.glsl, noise/gradient.glsl,
//            scene/air_reading.glsl, scene/footprint.glsl, scene/ground_reading.glsl,
//            scene/surfaces.glsl, scene/water/mirrored.glsl, scene/water/mirrored_sky.glsl,
//            scene/water/moment_texels.glsl, water/body.glsl, water/foam.glsl,
//            water/rough_mirror.glsl, water/waves.glsl, view/surface.glsl;
//            the picture without water, what scene/water/where gives, the ground and the maps
//            that scene/shaded has
//   units    metres; light without unit, 1 for white
//   source   each part in its own file; wet ground is darker: Lekner and Dorf 1988, "Why some
//            things are darker when wet", Applied Optics 27
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
const float WASH = 0.25;          // longest waves that foam is wide at a wall
const float HIDDEN = 0.35;        // of the slopes' deviation: flatter rays meet another wave
const float REPEATS = 3.0;        // [s] after which what a current carries begins again

float density_at(vec2 share) {
    return height_at(density, clamp(share, 0.0, 1.0) * vec2(textureSize(density, 0) - 1));
}

float wood_height(vec2 share) {
    return tallest * 0.85 * smoothstep(0.1, 0.6, density_at(share));
}

float cloud_shade(vec3 place, vec3 to_light) {
    vec4 wind_of = texelFetch(moment, DRIFT, 0);
    if (!wired_cloud || clouds == 0 || wind_of.w <= 0.0) return 1.0;
    return wired_daylight ? cloud_share(cloud, wind_of, place, to_light)
            : cloud_transmittance(cloud, wind_of, place, to_light);
}

// The air between the eye and what lies so far away at a place of the picture.
Aerial air_before(vec2 share, float far) {
    if (wired_scattered && wired_left) return aerial(scattered, left, share, far);
    vec3 air = wired_daylight ? horizon_of(daylight, 0.001 * (base_elevation + eye.z)) : horizon;
    float clean = exp(-haze * far / max(extent.x, extent.y));
    return Aerial(air * (1.0 - clean), vec3(clean));
}

// The terrain's own colour there, of a texture or of four tiles by their means.
vec3 colour_from(vec2 share, float wide) {
    if (!wired_colour && !wired_weights) return vec3(0.4);
    ivec2 texels = wired_weights ? textureSize(weights, 0) : textureSize(colour, 0);
    vec2 many = wide * vec2(texels - 1) / extent;
    float level = log2(max(max(many.x, many.y), 1e-3));
    vec2 at = drape_uv(share, texels);
    if (!wired_weights) return textureLod(colour, at, level).rgb;
    vec4 weight = textureLod(weights, at, level);
    vec3 total = vec3(0.0);
    for (int k = 0; k < 4; k++) {
        total += weight[k] * texelFetch(moment, TILES + ivec2(k, 0), 0).rgb;
    }
    return total / max(weight.x + weight.y + weight.z + weight.w, 1e-3);
}

// Light of the terrain that a mirrored ray meets, seen from as far as the ray has come.
vec3 terrain_from(vec3 place, vec3 to_ray, float far, float pixel, Sunlight from) {
    vec2 share = place.xy / extent;
    Ground around = ground_at(ground, place.xy, extent, far * pixel);
    vec3 found = colour_from(share, far * pixel);
    vec3 normal = normal_of_slope(around.slope);
    // Rocks and crowns are lighter and darker than their mean.
    float shown = clamp(14.0 / (far * pixel) - 1.0, 0.0, 1.0);
    float lump = shown * perlin(place.xy / 14.0 + place.z / 9.0, SALT + 3u).x;
    float wood = wired_density ? smoothstep(0.1, 0.6, density_at(share)) : 0.0;
    found = mix((1.0 + 0.35 * lump) * found,
                (1.0 + 0.6 * lump) * texelFetch(moment, WOOD, 0).rgb, wood);
    // Crowns are spheres, of which the ray sees the lit side or the other (Lambert's sphere).
    float away = acos(clamp(dot(to_ray, from.direction), -1.0, 1.0));
    float crown = 2.0 / 3.0 * (sin(away) + (3.14159265 - away) * cos(away)) / 3.14159265;
    float facing = mix(max(dot(normal, from.direction), 0.0), 0.85 * crown, wood);
    if (from.direction.z < 0.0) facing = 0.0;
    float lit = gain * around.sun * facing * cloud_shade(place, from.direction);
    return found * (from.sun * lit + from.sky * (ambient * around.sky * mix(1.0, 0.6, wood)));
}

// What the current carries begins again every few seconds, in two layers that take turns.
Waves river_waves(vec2 current, float white, vec2 place, Footprint foot) {
    Sea river = river_of(length(current), white);
    vec2 turn = fract(vec2(0.0, 0.5) + time / REPEATS);
    vec2 weight = 1.0 - abs(2.0 * turn - 1.0);
    weight /= length(weight);
    vec2 first = place - current * (turn.x * REPEATS);
    vec2 second = place - current * (turn.y * REPEATS) + 71.3;
    Waves one = waves_at(moment, 1, river, first, time, foot);
    Waves other = waves_at(moment, 1, river, second, time, foot);
    return Waves(weight.x * one.slope + weight.y * other.slope, one.variance);
}

struct Lit {
    Sunlight from;
    vec3 beam;   // of the sun on what faces it, under the clouds and the terrain's shadow
    vec3 level;  // of the sun on the level surface
    vec3 sky;
};

Lit light_on(vec3 place, Ground around) {
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    vec3 beam = from.sun * (gain * cloud_shade(place, from.direction));
    if (from.direction.z <= 0.0) beam = vec3(0.0);
    return Lit(from, beam, beam * (around.sun * max(from.direction.z, 0.0)),
               from.sky * (ambient * around.sky));
}

// `rough`: the deviation of the slopes that a pixel does not show, `lowest` how steeply the lowest
// of the mirrored rays rise that no other wave is in the way of.
vec3 mirrored_light(Mirrors mirrors, vec3 place, float far, float pixel, float rough,
                    float lowest, Aerial air, Lit lit) {
    // What of the mirrors has the sky, and what the terrain, where on the mean.
    vec3 total = vec3(0.0);
    vec3 mean = vec3(0.0);
    vec4 met = vec4(0.0);
    for (int k = 0; k < MIRRORS; k++) {
        vec3 to = mirrors.to[k];
        mean += mirrors.share[k] * to;
        vec3 risen = normalize(vec3(to.xy, length(vec2(to.z, lowest))));
        float way = meets_terrain(height, block_maxima, place, risen, extent, relief,
                                  wired_density ? tallest : 0.0);
        if (way < 0.0) total += mirrors.share[k] * sky_of(heaven, CLEAR_SKY, to);
        else met += mirrors.share[k] * vec4(way * risen, 1.0);
    }
    vec4 wind_of = texelFetch(moment, DRIFT, 0);
    if (clouds != 0 && wired_cloud && wind_of.w > 0.0) {
        vec4 found = clouds_towards(cloud, heaven, wind_of, place, normalize(mean),
                                    LOBE * rough + pixel, clouds == 2);
        total = total * found.a + max(mirrors.mirrored - met.w, 0.0) * found.rgb;
    }
    if (met.w <= 0.0) return total;
    vec3 hit = place + met.xyz / met.w;
    float way = distance(place, hit);
    vec3 found = terrain_from(hit, (place - hit) / max(way, 1e-3), far + way, pixel, lit.from);
    // Seen straight from the eye the air before it is about that along the mirrored path.
    vec4 clip = clip_from_world * vec4(hit, 1.0);
    vec2 share = clip.w > 0.0 ? clip.xy / clip.w * 0.5 + 0.5 : vec2(0.5);
    Aerial there = air_before(clamp(share, 0.0, 1.0), far + way);
    vec3 added = max(there.scattered - air.scattered, 0.0);
    return total + met.w * (found * there.left + added) / max(air.left, 1e-3);
}

// The wind over its mean, in patches and in groups of waves.
float gust_at(vec2 place, float pixel, float longest) {
    vec2 run = time * wind * vec2(sin(radians(wind_to)), cos(radians(wind_to)));
    float wide = clamp(170.0 / max(pixel, 1.0) - 1.0, 0.0, 1.0);
    float found = wide * perlin((place - run) / 370.0, SALT).x
            + wide * 0.7 * perlin((place - 0.8 * run) / 90.0, SALT + 1u).x;
    float group = 5.0 * longest;
    float near = clamp(0.5 * group / pixel - 1.0, 0.0, 1.0);
    if (near > 0.0) found += near * 0.8 * perlin((place - 0.3 * run) / group, SALT + 2u).x;
    return clamp(1.0 + 1.5 * gusts * found, 0.05, 2.5);
}

// How high waves reach over the water.
float reach_of_waves() { return 0.15 + 0.5 * sea_of(wind, fetch, vec2(0.0)).high; }

// A band along the shore, so high, that is narrower than a pixel has no more of it than its share.
float band_share(float high, float slope, float pixel_wide) {
    return clamp(0.5 * high / (max(slope, 0.02) * pixel_wide), 0.0, 1.0);
}

// Where waves run up a shore, and where they wash against a wall, in pieces along it.
float foam_at_shore(vec3 place, Ground around, Footprint foot, float pixel, Sea sea, float gust) {
    if (any(greaterThan(abs(place.xy / extent - 0.5), vec2(0.5)))) return 0.0;
    vec2 at = place.xy / extent * vec2(textureSize(height, 0) - 1);
    float deep_here = max(place.z - relief * height_at(height, at), 0.0);
    float steep = length(around.slope);
    float shore = shore_cover(deep_here, sea.high, time, gust)
            * band_share(BREAKER * sea.high, steep, pixel);
    vec2 off = around.slope / max(steep, 1e-6);
    float across = abs(dot(off, foot.right)) + abs(dot(off, foot.up));
    float wash = wash_cover(deep_here / max(steep, 0.05), WASH * sea.longest, across);
    float lump = perlin(place.xy / (3.0 * sea.longest), SALT + 4u).x;
    float broken = clamp(0.6 + 1.6 * lump, 0.0, 1.0);
    return max(shore, wash * broken * min(sea.high / 0.4, 1.0));
}

vec4 dry(ivec2 texel, vec4 shown, vec4 at, float over) {
    // Ground that waves have reached is wet, and darker.
    float reach = reach_of_waves();
    Aerial air = air_before((vec2(texel) + 0.5) / vec2(size), distance(eye, at.xyz));
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    float wide = distance(eye, at.xyz) * length(ray.up) / length(ray.ahead);
    float slope = length(ground_at(ground, at.xy, extent, wide).slope);
    float wet = 0.4 * band_share(reach, slope, wide) * (1.0 - smoothstep(0.0, reach, over));
    return vec4(shown.rgb - wet * max(shown.rgb - air.scattered, 0.0), shown.a);
}

vec4 kernel(ivec2 texel) {
    vec4 shown = texelFetch(picture, texel, 0);
    vec4 at = texelFetch(seen_water, texel, 0);
    vec4 here = texelFetch(state, texel, 0);
    bool wet = is_water(at.w) || (is_top(at.w) && -here.x <= reach_of_waves());
    if (!wet) return shown;
    if (skips_rest()) return vec4(0.0);
    if (!is_water(at.w)) return dry(texel, shown, at, -here.x);
    vec3 place = at.xyz;
    float far = distance(eye, place);
    vec3 to_eye = (eye - place) / far;
    PixelRay ray = pixel_ray(world_from_clip, eye, vec2(texel) + 0.5, vec2(size));
    Footprint foot = footprint_of(ray, place - eye, vec3(0.0, 0.0, 1.0));
    float pixel = length(ray.up) / length(ray.ahead);
    Ground around = ground_at(ground, place.xy, extent, far * pixel);
    Lit lit = light_on(place, around);
    Aerial air = air_before((vec2(texel) + 0.5) / vec2(size), far);

    Sea sea = sea_of(wind, fetch, vec2(sin(radians(wind_to)), cos(radians(wind_to))));
    float gust = gust_at(place.xy, far * pixel, sea.longest);
    bool runs = length(here.yz) > MOVING;
    Waves seen_waves;
    if (runs) {
        seen_waves = river_waves(here.yz, here.w, place.xy, foot);
    } else {
        Waves even = waves_at(moment, 0, sea, place.xy, time, foot);
        seen_waves = Waves(even.slope * sqrt(gust), even.variance * gust);
    }
    Mirrors mirrors = mirrors_of(to_eye, seen_waves.slope, seen_waves.variance);
    float lowest = HIDDEN * sqrt(runs ? seen_waves.variance : sea.variance * gust);
    vec3 above = mirrored_light(mirrors, place, far, pixel, sqrt(seen_waves.variance), lowest,
                                air, lit);

    float glint = sun_glint(to_eye, lit.from.direction, seen_waves.slope, seen_waves.variance,
                            mirrors.area);
    if (glint > 1e-3) {
        float shaded = meets_terrain(height, block_maxima, place, lit.from.direction, extent,
                                     relief, wired_density ? tallest : 0.0);
        glint = shaded < 0.0 ? glint : 0.0;
        above += sun_image(lit.beam, glint);
    }

    // Where there is no bed it is too deep for any of what is shown there.
    vec3 bed = max(shown.rgb - air.scattered, 0.0) / max(air.left, 1e-3);
    float path = path_in_water(here.x, lit.from.direction.z, to_eye.z);
    vec3 kept = light_left(attenuation_of(clarity), path);
    vec3 down = light_down(lit.level, lit.sky, lit.from.direction.z);
    vec3 in_air = max(lit.level + lit.sky, 1e-6);
    vec3 below = bed * (down / in_air) * kept + deep * down * (1.0 - kept);

    float cover = foam_at_shore(place, around, foot, far * pixel, sea, gust);
    cover += whitecap_cover(wind * sqrt(gust)) + here.w;
    // Whitecaps lie across the wind, and are drawn out along it.
    vec2 along = place.xy - time * here.yz;
    along -= sea.towards * (0.6 * dot(along, sea.towards) + 0.5 * wind * time);
    float white = foam_of(clamp(foam * cover, 0.0, 1.0), along,
                          runs ? 0.7 : clamp(0.1 * sea.longest, 0.6, 3.0), far * pixel);
    vec3 found = above + (1.0 - mirrors.mirrored) * below;
    found = mix(found, FOAM_ALBEDO * (lit.level + lit.sky), white);
    return vec4(found * air.left + air.scattered, 1.0);
}
