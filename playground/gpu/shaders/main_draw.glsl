layout(location = 0) out vec4 k_out;
void main() {
    k_out = fragment($arguments);
}
