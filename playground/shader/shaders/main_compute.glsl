vec4 k_filled(float k_value) { return vec4(k_value, 0.0, 0.0, 1.0); }
vec4 k_filled(vec2 k_value) { return vec4(k_value, 0.0, 1.0); }
vec4 k_filled(vec4 k_value) { return k_value; }

void main() {
    ivec2 k_texel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(k_texel, size))) return;
    $call
}
