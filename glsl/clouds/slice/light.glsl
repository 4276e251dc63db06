// clouds/slice/light.glsl -- what a cloud leaves of the sun's beam, in a slice.
//
//   gives    beam: what is left of it at each place of the slice, 0..1; picture
//   needs    a density and a ground by clouds/slice/density
//   units    metres; extinction per metre; light without unit, 1 for white
//   source   the law of Beer and Lambert
//   tested   tests/glsl/test_lesson_outdoors.py, against sums along the ray in float64
//
// The integral itself, by steps. clouds/seen and clouds/shadow replace the steps towards the sun
// by depths that are known from the form of their layer.
#pragma kernel(output = "beam:r32f, picture:rgba16f")

uniform sampler2D slice;          //! input("linear")
uniform float sun = 52.0;         //! slider(10, 170) step(1) unit("°") From the right over the
                                  //! zenith to the left
uniform float extinction = 0.01;  //! log_slider(0.0005, 0.1) unit("1/m") Of the densest cloud
uniform float around = 0.35;      //! slider(0, 1) step(0.01) Light from all around, of the beam's

const int STEPS = 96;

vec2 slice_at(vec2 texel) {
    vec2 share = (texel + 0.5) / vec2(textureSize(slice, 0));
    return textureLod(slice, share, 0.0).rg;
}

void kernel(ivec2 texel, out float beam, out vec4 picture) {
    vec2 towards = vec2(cos(radians(sun)), sin(radians(sun)));
    float step_of = 0.7 * extent.y / float(STEPS);
    // anchor: beam
    float depth = 0.0;
    for (int i = 0; i < STEPS; i++) {
        vec2 ahead = (float(i) + 0.5) * step_of * towards;
        depth += slice_at(vec2(texel) + ahead / spacing).r * extinction * step_of;
    }
    beam = exp(-depth);
    // end: beam
    vec2 here = slice_at(vec2(texel));
    float up = float(texel.y) / float(size.y);
    vec3 sky = mix(vec3(0.55, 0.68, 0.85), vec3(0.16, 0.32, 0.62), up);
    vec3 light = vec3(1.0, 0.95, 0.86) * beam + around * vec3(0.75, 0.87, 1.0);
    float opaque = 1.0 - exp(-1000.0 * extinction * here.r);
    picture = vec4(mix(sky, 0.8 * light, opaque), 1.0);
    if (here.g > 0.5) picture.rgb = vec3(0.17, 0.20, 0.07) * light;
}
