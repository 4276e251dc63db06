"""Shrink a sketch that fails to the least text that still fails in the same way.

    edits.py         the smaller texts of a text, by its tree and types; one form to print them in
    case.py          a sketch without nesting: its passes, their texts, what is set; a loaded sketch → a case
    candidate.py     a case → how it fails, drawn in a worker: crashes and hangs are results
    search.py        what is tried, in which order, until nothing more goes
    initial_case.py  what fails, and in which pass
    output.py        the folder that is left

Each knows only those above it. Importing this opens nothing.
"""
