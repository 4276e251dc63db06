"""A lesson in front of a class: its blocks as beats, each with little to read and one picture."""
