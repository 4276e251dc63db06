"""Two states of a sketch side by side."""
