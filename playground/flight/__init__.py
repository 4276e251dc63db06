"""Flight: over endless terrain that is generated during the flight, with record and replay.

``layout`` says what a flight requires of a sketch; ``window`` alone opens one. Needs the core and the studio.
To delete it: this folder, tests/flight and its line in rooms.py.
"""
