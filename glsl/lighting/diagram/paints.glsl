// lighting/diagram/paints.glsl -- the diagrams' colours, which the colour-blind can distinguish.
//
//   gives    SKY, GROUND, EDGE, INK, FREE, PARTLY, HIDDEN, SUN, DULL
//   needs    nothing
//   units    linear
//   source   blue and amber as in Okabe and Ito 2002, "Color Universal Design"; the rest chosen
//            here
//   tested   tests/glsl/test_diagrams.py, by where they are
#ifndef LIGHTING_DIAGRAM_PAINTS
#define LIGHTING_DIAGRAM_PAINTS

const vec3 SKY = vec3(0.86, 0.90, 0.93);
const vec3 GROUND = vec3(0.58, 0.47, 0.33);
const vec3 EDGE = vec3(0.05, 0.035, 0.02);   // the terrain's surface
const vec3 INK = vec3(0.012, 0.012, 0.014);  // letters, level lines
const vec3 FREE = vec3(0.0, 0.168, 0.445);   // where nothing hides the sun
const vec3 PARTLY = vec3(0.79, 0.347, 0.0);
const vec3 HIDDEN = vec3(0.434, 0.006, 0.023);
const vec3 SUN = vec3(1.0, 0.578, 0.047);
const vec3 DULL = vec3(0.25, 0.20, 0.13);    // the hidden part of the sun
#endif
