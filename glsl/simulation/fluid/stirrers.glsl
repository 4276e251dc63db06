// simulation/fluid/stirrers.glsl -- three stirrers that go round in the fluid, and their colours.
//
//   gives    STIRRERS, stirrer_place, stirrer_motion, stirrer_colour, nearness
//   needs    nothing: pure functions, no uniforms, no textures
//   units    places and radii as shares of the field's sides; motion in shares a second;
//            seconds; colours linear
//   source   none: made here
//   tested   tests/glsl/test_fluid.py, by derivatives and by the torus
#ifndef SIMULATION_FLUID_STIRRERS
#define SIMULATION_FLUID_STIRRERS

const int STIRRERS = 3;

// How fast each goes round [radians/s], one against the others.
float stirrer_speed(int k) { return k == 1 ? -1.1 : 0.7 + 0.35 * float(k); }

// Where a stirrer is.
vec2 stirrer_place(int k, float seconds) {
    float turn = stirrer_speed(k) * seconds + 2.0943951 * float(k);
    return 0.5 + (0.16 + 0.07 * float(k)) * vec2(cos(turn), sin(turn));
}

// Its derivative by time.
vec2 stirrer_motion(int k, float seconds) {
    float turn = stirrer_speed(k) * seconds + 2.0943951 * float(k);
    return stirrer_speed(k) * (0.16 + 0.07 * float(k)) * vec2(-sin(turn), cos(turn));
}

vec3 stirrer_colour(int k) {
    return k == 0 ? vec3(0.9, 0.25, 0.05) : k == 1 ? vec3(0.05, 0.35, 0.9) : vec3(0.95, 0.75, 0.2);
}

// 1 at a stirrer, 0 from a radius on, on a torus.
float nearness(vec2 place, vec2 stirrer, float radius) {
    vec2 offset = abs(place - stirrer);
    offset = min(offset, 1.0 - offset);
    float share = min(dot(offset, offset) / (radius * radius), 1.0);
    return (1.0 - share) * (1.0 - share);
}
#endif
