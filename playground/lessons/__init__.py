"""Lessons: Markdown with TOML blocks, read into what a window, a book or a notebook shows.

texts/en/NAME.md    a lesson; all pictures, numbers and code are named there
texts/fr/NAME.md    its words in another language, and nothing else
model               what a lesson is made of
read, fences        from a file to that
translate           from a translation to that; which of it has gone stale
library             which lessons and languages there are
pictures, measures  what is drawn and computed for one
excerpt             code by a named anchor
rules               what every lesson keeps to
"""
