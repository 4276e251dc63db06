vec4 k_filled(float k_value) { return vec4(k_value, 0.0, 0.0, 1.0); }
vec4 k_filled(vec2 k_value) { return vec4(k_value, 0.0, 1.0); }
vec4 k_filled(vec4 k_value) { return k_value; }

void main() {
    ivec2 k_cell = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(k_cell, k_cells))) return;
    ivec2 k_texel = visit(k_cell);
    if (any(lessThan(k_texel, ivec2(0))) || any(greaterThanEqual(k_texel, size))) return;
    $call
}
