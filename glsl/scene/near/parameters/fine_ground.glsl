// scene/near/parameters/fine_ground.glsl -- whether the ground is finer than its maps.
//
//   gives    fine_ground
//   needs    nothing
//   units    none
//   source   none: a parameter
//   tested   tests/glsl/test_near.py
#ifndef SCENE_NEAR_PARAMETERS_FINE_GROUND
#define SCENE_NEAR_PARAMETERS_FINE_GROUND
uniform bool fine_ground = false; //! group("Near ground") label("Fine ground")
                                  //! Bumps and colours finer than the terrain's own
#endif
