"""Drive a session from outside: HTTP, OSC, MIDI."""
