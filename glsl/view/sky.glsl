// view/sky.glsl -- what is behind the land: one colour overhead, one at the horizon, one underfoot.
//
//   gives    frame, linear light
//   needs    the camera
//   units    colours linear
//   source   none: a backdrop. The physical sky is a technique of its own
//   tested   tests/glsl/test_view.py: the horizon's colour at the horizon, overhead's above
#pragma kernel(output = "frame:rgba16f")

uniform vec3 zenith = vec3(0.105, 0.245, 0.56);  //! colour group("Sky") Straight overhead
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);   //! colour group("Sky") Level with the eye
uniform vec3 nadir = vec3(0.125, 0.19, 0.27);     //! colour group("Sky") Straight underfoot, where there is no land

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * 2.0 - 1.0;
    vec4 away = world_from_clip * vec4(place, 1.0, 1.0);
    vec3 towards = normalize(away.xyz / away.w - eye);
    // Both halves leave the horizon at the same pace, so that no line is seen there.
    float share = 1.0 - exp(-3.0 * abs(towards.z));
    return vec4(mix(horizon, towards.z > 0.0 ? zenith : nadir, share), 1.0);
}
