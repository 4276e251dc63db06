"""A reader and the lessons, without a window: pages, figures, broken shaders, progress."""
