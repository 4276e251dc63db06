"""The start page: recent sketches, new ones, files, the shipped sketches by subject, lessons."""
