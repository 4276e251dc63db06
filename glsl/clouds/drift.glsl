// clouds/drift.glsl -- where the wind has carried the clouds, and where their layer is.
//
//   gives    drift: metres east and north, 0 up to a tile's width; the layer's base over the
//            terrain's height 0; the width of a tile
//   needs    the time
//   units    metres; metres a second
//   source   none: wind times time, in tiles
//   tested   tests/glsl/test_clouds.py: exact, and after a tile's width the same
//
// All that reads the clouds reads these, so they are in one place for the sky and for the shadows.
#pragma kernel(output = "drift:rgba32f")

uniform vec2 wind = vec2(8.0, 3.0);   //! slider(-50, 50) step(0.5) unit("m/s") parts("E", "N")
                                      //! What the clouds move by, east and north
uniform float pace = 1.0;             //! log_slider(0.1, 1000) How much faster than in nature
uniform float base = 2200.0;          //! slider(100, 12000) step(10) unit("m")
                                      //! Height of the clouds' flat feet above sea level
uniform float wide = 12000.0;         //! log_slider(1000, 100000) unit("m")
                                      //! Width of a tile, after which the same clouds come again

vec4 kernel(ivec2 texel) {
    vec2 tiles = wind * (pace / wide * time);
    return vec4((tiles - floor(tiles)) * wide, base - base_elevation, wide);
}
