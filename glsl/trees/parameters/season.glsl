// trees/parameters/season.glsl -- the day of the year for leaves, if no daylight has it.
//
//   gives    day
//   needs    nothing
//   units    days from the first of January
//   source   none
//   tested   tests/glsl/test_trees_light.py
#ifndef TREES_PARAMETERS_SEASON
#define TREES_PARAMETERS_SEASON
uniform float day = 180.0;  //! slider(0, 365) step(1) unit("d") group("Species")
                            //! Day of the year where no daylight says it: spring, summer,
                            //! autumn, bare
#endif
