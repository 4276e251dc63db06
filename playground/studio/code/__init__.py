"""A shader's text in the window or in an editor."""
