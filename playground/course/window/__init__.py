"""Lessons in the live window: a panel of text next to the picture, which is the live view itself."""
