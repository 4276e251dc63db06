"""Exercises that check themselves, and pictures to match.

``work`` is what a student hands in, ``judge`` compares it with the model answer, and ``sentences``
says what differs.
"""
