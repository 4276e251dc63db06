// scene/near/parameters/near.glsl -- the ground near the eye, finer than the heightmap and colour.
//
//   gives    bumpiness, variation, soils, stony, sandy, ripples_from, cliffs, rocky, cliff_colour,
//            coloured_rock, strata, thickness, wet
//   needs    nothing
//   units    metres; slopes in metres over metres; colours linear; shares 0..1
//   source   none: parameters
//   tested   tests/glsl/test_near.py
#ifndef SCENE_NEAR_PARAMETERS_NEAR
#define SCENE_NEAR_PARAMETERS_NEAR
uniform float bumpiness = 1.0;    //! slider(0, 2) step(0.01) group("Near ground")
                                  //! How strong bumps are, and light and dark with them
uniform float variation = 0.5;    //! slider(0, 1) step(0.01) group("Near ground")
                                  //! Fresh and dry patches, tens to hundreds of metres wide
uniform float stony = 0.2;        //! slider(0, 1) step(0.01) group("Near ground")
                                  //! How much of the ground is stones and no grass
uniform float sandy = 0.0;        //! slider(0, 1) step(0.01) group("Near ground")
                                  //! How smooth it is, as sand is, but for ripples
uniform float ripples_from = 270.0;  //! angle(0, 360) group("Near ground")
                                  //! Where the wind comes from that ripples sand
uniform float soils = 0.5;        //! slider(0, 1) step(0.01) group("Near ground")
                                  //! How much stony ground takes the hue of bare soil
uniform bool cliffs = false;      //! group("Rock") label("Cliffs")
                                  //! Bare rock where the ground is steep
uniform vec2 rocky = vec2(0.6, 1.1);  //! slider(0, 5) step(0.01) group("Rock")
                                  //! parts("from", "alone") Slopes between which it comes
uniform vec3 cliff_colour = vec3(0.19, 0.165, 0.14);  //! colour group("Rock") Its colour
uniform float coloured_rock = 1.0;  //! slider(0, 1) step(0.01) group("Rock")
                                  //! How much of that it has; 0: the colour of the ground
uniform float strata = 0.6;       //! slider(0, 1) step(0.01) group("Rock")
                                  //! How much its layers differ
uniform float thickness = 12.0;   //! log_slider(0.2, 100) unit("m") group("Rock")
                                  //! How thick the thickest layers are
uniform float wet = 1.0;          //! slider(0, 1) step(0.01) group("Near ground")
                                  //! How much of the wired wetness is seen
#endif
