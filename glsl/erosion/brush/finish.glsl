// erosion/brush/finish.glsl -- the height after a stamp of a brush, and water for the next.
//
//   gives    height; water: red its depth, green what it carries, blue the rock that has left
//            with it since the stroke began
//   needs    nothing; the state has the size of this pass
//   units    height in units of relief, the water's numbers in metres
//   source   none: made here
//   tested   tests/glsl/test_erosion_brush.py, by the rock's budget
#pragma kernel(output = "height:r32f, water:rgba32f")

uniform sampler2D state;  //! input

uniform int hours = 8;   //! slider(1, 200) unit("h") How long it rains in a stamp of the brush

void kernel(ivec2 texel, out float height, out vec4 water) {
    vec4 now = texelFetch(state, texel, 0);
    height = now.x / max(relief, 1e-3);
    water = vec4(now.yzw, 0.0);
}
