"""Shrink a sketch that fails to the least text that still fails in the same way.

    ddmin.py     the least part of a list that still passes a test
    tokens.py    GLSL as tokens, and as text with one statement a line
    blocks.py    a text as lines and blocks, some of them left out
    edits.py     small edits of a text that may make it smaller
    case.py      a sketch laid flat: its passes, their texts, what is set
    lay.py       a loaded sketch → a case
    faults.py    what counts as failing, and as failing in the same way
    child.py     the process in which candidates are drawn
    worker.py    its parent: it survives crashes and hangs
    probe.py     a case → what came of it
    search.py    what is tried, in which order, until nothing more goes
    start.py     what fails, and in which pass
    output.py    the folder that is left

Each knows only those above it. Importing this opens nothing.
"""
