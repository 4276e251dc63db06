void main() {
    gl_Position = vertex($arguments);
    // A window of a larger picture is cut out of its clip space.
    $zoom
}
