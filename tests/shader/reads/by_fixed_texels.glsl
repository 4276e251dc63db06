// How inputs are read, and those of which nothing but texels at places written as numbers is read.

//// in the kernel: sun
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r; }

//// by a function: sun
float at(bool is, sampler2D sun) { return is ? texelFetch(sun, ivec2(1, 0), 0).a : 0.0; }
float kernel(ivec2 t) { return (at(t.x > 0, sun)) + max(at(true, sun), 1.0); }

//// of two: moon sun
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * texelFetch(moon, ivec2(0), 0).r; }

//// beside a variable of its name: sun
float near(float sun) { return sun; }
float kernel(ivec2 t) { return near(texelFetch(sun, ivec2(3), 0).r); }

//// and elsewhere: 
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r + texelFetch(sun, t, 0).r; }

//// and filtered: 
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r + textureLod(sun, vec2(t), 0.0).r; }

//// and its size: 
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * float(textureSize(sun, 0).x); }

//// and by a function that calls it otherwise: 
float at(sampler2D which) { return textureLod(which, vec2(0.0), 0.0).r; }
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * at(sun); }

//// and by a function at any place: 
float at(sampler2D sun, ivec2 t) { return texelFetch(sun, t, 0).r; }
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * at(sun, t); }

//// and by a macro: 
#define AT(t) texelFetch(sun, t, 0)
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r * AT(t).r; }
