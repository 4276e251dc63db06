// What sky, air and terrain are drawn with: the daylight, and the matrices of the lens.
uniform sampler2D daylight;
uniform bool natural;
uniform vec3 zenith;
uniform vec3 horizon;
uniform float altitude;  // of the eye over the sea [km]
uniform float pixel;
uniform mat4 clip_from_near;
uniform mat4 near_from_clip;
uniform float eye_up;    // above height 0 [m]
