// How an input is read, and the inputs that are read by nothing but fetches. A fetch that is found has a ■.

//// in the kernel: moon sun
float kernel(ivec2 t) { return ■texelFetch(sun, t, 0).r; }

//// at a place with calls and brackets: moon sun
float kernel(ivec2 t) {
    return ■texelFetch( sun,clamp(ivec2(t[0], max(t.y, 1)), ivec2(0), textureSize(sun, 0)), 0 ).r + ■texelFetch(moon, t, 0).g; }

//// by a function that is handed both: moon sun
float at(sampler2D which, ivec2 t) { return ■texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return at(sun, t) + at(moon, t + 1); }

//// down a chain, with other names: moon sun
float at(sampler2D which, ivec2 t) { return ■texelFetch(which, t, 0).r; }
float twice(float by, sampler2D one) { return by * at(one, ivec2(2)); }
float kernel(ivec2 t) { return twice(float(t.x), sun); }

//// by a function that calls itself: moon sun
float at(sampler2D sun, int n) { return n > 0 ? at(sun, --n) : ■texelFetch(sun, ivec2(7), 0).r; }
float kernel(ivec2 t) { return at(sun, 3); }

//// in a call within a call: moon sun
float at(sampler2D which, ivec2 t) { return ■texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return max(at(sun, ivec2(at(moon, t), 0)), 1.0); }

//// beside a variable of its name: moon sun
float near(float moon, ivec2 t) { return max(moon, 1.0) * (moon + float(t.x)); }
float kernel(ivec2 t) { vec2 sun = vec2(2.0, 3.0); return near(sun.x, ivec2(sun)); }
float other(ivec2 t) { return ■texelFetch(sun, t, 0).r + ■texelFetch(moon, t, 0).r; }

//// in brackets: moon sun
float at(sampler2D which, ivec2 t) { return ■texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return at((sun), t) + ■texelFetch(moon, t, 0).r; }

//// by another function of GLSL: 
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + texelFetchOffset(sun, t, 0, t).r + textureGrad(moon, vec2(t), vec2(0.0), vec2(0.0)).r; }

//// by another level: moon
float kernel(ivec2 t) { return texelFetch(sun, t, 1).r; }

//// by a level that is worked out: moon
float kernel(ivec2 t) { return texelFetch(sun, t, t.x).r; }

//// and filtered: moon
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + textureLod(sun, vec2(t), 0.0).r + ■texelFetch(moon, t, 0).r; }

//// and filtered by a function: moon
float at(sampler2D sun) { return textureLod(sun, vec2(0.5), 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + at(sun) + ■texelFetch(moon, t, 0).r; }

//// by a function that may be handed one that is filtered: sun
float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return at(sun, t) + at(moon, t) + textureLod(moon, vec2(t), 0.0).r; }

//// by a function that may be handed an image file: moon sun
float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return at(sun, t) + at(image, t); }

//// by one of two functions of a name, of which the other filters: moon
float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }
float at(sampler2D which, vec2 t) { return textureLod(which, t, 0.0).r; }
float kernel(ivec2 t) { return at(sun, t) + ■texelFetch(moon, t, 0).r; }

//// by a function that nothing calls: moon sun
float at(sampler2D which, ivec2 t) { return texelFetch(which, t, 0).r; }
float kernel(ivec2 t) { return ■texelFetch(moon, t, 0).r; }

//// by a macro: moon sun
#define AT(t) texelFetch(sun, t, 0)
float kernel(ivec2 t) { return AT(t).r; }

//// by a macro that is handed it: moon sun
#define AT(s) texelFetch(s, ivec2(0), 0)
float kernel(ivec2 t) { return AT(sun).r; }

//// by a function that a macro calls: moon sun
float at(sampler2D which) { return ■texelFetch(which, ivec2(0), 0).r; }
#define FIRST at
float kernel(ivec2 t) { return FIRST(sun) + at(moon); }

//// by what a macro makes of the name: moon
#define texelFetch(s, p, l) textureLod(s, vec2(p), 0.0)
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r; }

//// by a function that returns several numbers: moon
float[2] two(sampler2D which, vec2 p) { return float[2](textureLod(which, p, 0.0).r, 0.0); }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t))[0]; }

//// by a function with a line end in its argument: moon
float two(sampler2D
    which, vec2 p) { return textureLod(which, p, 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }

//// by a function whose argument has a macro's type: moon
#define Map sampler2D
float two(Map which, vec2 p) { return textureLod(which, p, 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }

//// by a function behind a macro: moon
#define SQUARE(T) T square(T x) { return x * x; }
SQUARE(vec2)
float two(sampler2D which, vec2 p) { return textureLod(which, p, 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }

//// by a function behind a head that is written twice: 
#if 1
float one(float x) {
#else
float one(float x, float y) {
#endif
    return x; }
float two(sampler2D which, vec2 p) { return textureLod(which, p, 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(sun, vec2(t)); }

//// by a function with brackets in its arguments: moon
float two(float w[(2)], sampler2D which) { return textureLod(which, vec2(w[0]), 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r + two(float[2](0.1, 0.2), sun); }

//// by a branch of another stage: moon
float kernel(ivec2 t) {
#ifdef COMPUTE_STAGE
    return textureLod(sun, vec2(t), 0.0).r;
#else
    return texelFetch(sun, t, 0).r;
#endif
}

//// by the text's own function of that name: moon
vec4 texelFetch(sampler2D which, ivec2 p, int l) { return textureLod(which, vec2(p), 0.0); }
float kernel(ivec2 t) { return texelFetch(sun, t, 0).r; }

//// in a comment: 
float kernel(ivec2 t) { return 1.0; } // texelFetch(sun, t, 0)
