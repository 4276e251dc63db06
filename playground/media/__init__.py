"""Films, sounds and live inputs: what a picture shows of them is a function of the time."""
