"""Fly over an endless land that is made while one flies: parts, budget, flight model, record and replay.

There is no window here. What a sketch must be for it, ``plot`` says.
"""
