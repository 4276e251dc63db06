"""Capture pictures and films from the window."""
