"""Capture pictures and films from a window of the studio."""
