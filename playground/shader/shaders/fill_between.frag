#version 330
// What lies between the nodes of a lattice, joined as engine/lattice.py says; k_form is its number
// there.
uniform sampler2D k_picture;
uniform int k_stride;
uniform int k_form;
out vec4 k_out;

vec4 at(ivec2 texel) {
    return texelFetch(k_picture, min(texel, textureSize(k_picture, 0) - 1), 0);
}

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    int side = k_form == 2 ? 2 * k_stride : k_stride;
    ivec2 low = texel / side * side;
    float x = float(texel.x - low.x) / float(side);
    float y = float(texel.y - low.y) / float(side);
    vec4 sw = at(low), se = at(low + ivec2(side, 0));
    vec4 nw = at(low + ivec2(0, side)), ne = at(low + side);
    if (k_form == 0) {  // bilinear in the square
        k_out = (sw * (1.0 - x) + se * x) * (1.0 - y) + (nw * (1.0 - x) + ne * x) * y;
        return;
    }
    if (k_form == 1) {  // linear in two triangles, cut from south-west to north-east
        k_out = x >= y ? sw * (1.0 - x) + se * (x - y) + ne * y
                       : sw * (1.0 - y) + nw * (y - x) + ne * x;
        return;
    }
    // Linear in four triangles around the square's centre. Each corner counts by how far the
    // texel is from the diagonal that does not go through it, on the corner's own side.
    float nearest = min(min(x, 1.0 - x), min(y, 1.0 - y));
    k_out = at(low + side / 2) * (2.0 * nearest);
    k_out += sw * max(1.0 - x - y, 0.0) + ne * max(x + y - 1.0, 0.0);
    k_out += se * max(x - y, 0.0) + nw * max(y - x, 0.0);
}
