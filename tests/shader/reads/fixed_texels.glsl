// The texels at places written as numbers that a text reads of its inputs: input, x, y.

//// in the kernel: sun 3 3
float kernel(ivec2 t) { return texelFetch(sun, ivec2(3), 0).r; }

//// two places on a line: sun 2 5 moon 0 0
float kernel(ivec2 t) { return texelFetch(sun, ivec2(2, 5), 0).r + texelFetch( moon,ivec2(0) , 0 ).g; }

//// by a function that is handed it under its own name: sun 1 0
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float kernel(ivec2 t) { return at(sun) * at( sun ); }

//// down a chain of functions: sun 1 0
float at(int k, sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float twice(sampler2D sun, vec2 p[2]) { return at(int(p[0].x), sun) * 2.0; }
float kernel(ivec2 t) { return twice(sun, vec2[2](vec2(1.0, 2.0), vec2(0.0))); }

//// by a function that a prototype announces: sun 4 4
float at(sampler2D sun);
float kernel(ivec2 t) { return at(sun); }
float at(sampler2D sun) { return texelFetch(sun, ivec2(4), 0).r; }

//// by a function that calls itself: sun 7 7
float at(sampler2D sun, int n) { return n > 0 ? at(sun, n - 1) : texelFetch(sun, ivec2(7), 0).r; }
float kernel(ivec2 t) { return at(sun, 3); }

//// at a place that is worked out: 
float kernel(ivec2 t) { return texelFetch(sun, ivec2(0, t.y), 0).r; }

//// of another level: 
float kernel(ivec2 t) { return texelFetch(sun, ivec2(0), 1).r; }

//// in a comment: 
float kernel(ivec2 t) { return 1.0; } // texelFetch(sun, ivec2(0), 0)

//// by a function that is handed another: 
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float kernel(ivec2 t) { return at(sun) * at(moon); }

//// by a function that is handed another further up: 
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float twice(sampler2D sun) { return at(sun) * 2.0; }
float kernel(ivec2 t) { return twice(moon); }

//// by a function whose argument has a name of its own: 
float at(sampler2D which) { return texelFetch(which, ivec2(1, 0), 0).r; }
float kernel(ivec2 t) { return at(sun); }

//// by one of two functions of a name: sun 1 0
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float at(sampler2D moon, int n) { return 1.0; }
float kernel(ivec2 t) { return at(sun) + at(moon, 2); }

//// by one of two functions of a name that may be meant: 
float at(sampler2D sun, float n) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float at(sampler2D sun, int n) { return 1.0; }
float kernel(ivec2 t) { return at(sun, 1.0) + at(moon, 2); }

//// by a function that has a variable of its name: sun 1 0
float other(float sun) { return sun; }
float kernel(ivec2 t) { return other(1.0) + texelFetch(sun, ivec2(1, 0), 0).r; }

//// by a function that is handed it as one of several: 
uniform sampler2D several[2];
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
float kernel(ivec2 t) { return at(sun) + at(several[1]); }

//// by a macro: 
#define AT(sun) \
    texelFetch(sun, ivec2(0), 0)
float kernel(ivec2 t) { return AT(moon).r; }

//// by a function that a macro calls: 
float at(sampler2D sun) { return texelFetch(sun, ivec2(1, 0), 0).r; }
#define AT at
float kernel(ivec2 t) { return AT(moon) + at(sun); }

//// of a name that a macro changes: 
#define sun moon
float kernel(ivec2 t) { return texelFetch(sun, ivec2(0), 0).r; }
