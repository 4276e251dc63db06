"""Ways to measure a row; each module has ``figures(row, room, size)``, which yields what it found."""
