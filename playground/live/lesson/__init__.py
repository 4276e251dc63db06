"""Lessons in the live window: a panel of text beside the picture, which is the live view itself.

    words.py      what is written around lessons, in each language
    progress.py   where a reader is, from one start to the next
    scene.py      a lesson's picture as what a hand could have set
    stage.py      what the view shows for a lesson, and what was open before
    copies.py     copies of shaders to break and mend; their files are never written
    faults.py     a reader's way with such a copy: broken, mended, edited
    numbers.py    the lesson's numbers, computed while nothing else is to be done
    shelf.py      the lessons that there are
    reading.py    a reader and the lessons: pages, pictures, what was asked and answered
    ways.py       where links and buttons lead from a page

    marks.py      Markdown as runs of one style
    lines.py      runs broken into lines
    formulas.py   LaTeX as textures
    prose.py      texts laid out and drawn
    page.py       what every block is drawn with
    pictures.py, asking.py, coding.py   the blocks
    panel.py      the panel
    beside.py     what the window asks of all that

Each knows only those above it.
"""
