"""Shrink a sketch that fails to the least text that still fails in the same way.

    ddmin.py     the least part of a list that still passes a test
    tokens.py    GLSL as tokens, and as text with one statement a line
    blocks.py    a text as lines and blocks, some of them left out
    edits.py     small edits of a text that may make it smaller
    case.py      a sketch without nesting: its passes, their texts, what is set
    inline.py    a loaded sketch → a case
    failures.py  what counts as failing, and as failing in the same way
    candidate_process.py    draw candidates in a worker: crashes and hangs are results
    probe.py     a case → what came of it
    search.py    what is tried, in which order, until nothing more goes
    initial_case.py    what fails, and in which pass
    output.py    the folder that is left

Each knows only those above it. Importing this opens nothing.
"""
