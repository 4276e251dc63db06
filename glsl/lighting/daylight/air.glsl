// lighting/daylight/air.glsl -- how hazy the air is: set once, for all that light does in it.
//
//   gives    air: the turbidity
//   needs    nothing
//   units    turbidity, without unit: 1 is clean air
//   source   Preetham, Shirley and Smits 1999, "A Practical Analytic Model for Daylight"
//   tested   tests/glsl/test_air.py: the tables are those of the turbidity that is set
#pragma kernel(output = "air:r32f")

uniform float turbidity = 2.5;     //! slider(1.5, 10) step(0.1)
                                   //! Haze: 2 very clear, 3 clear, 6 hazy

float kernel(ivec2 texel) {
    return turbidity;
}
