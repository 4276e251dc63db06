"""Fly over endless terrain, generated during the flight: parts, budget, flight model, record and replay.

There is no window here. ``layout`` says what a flight requires of a sketch.
"""
