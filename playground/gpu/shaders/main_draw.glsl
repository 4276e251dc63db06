void main() {
    $call
}
