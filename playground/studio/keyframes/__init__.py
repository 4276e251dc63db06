"""Keyframes and the bar of time."""
