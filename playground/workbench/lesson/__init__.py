"""A reader and the lessons, without a window: pages, figures, broken shaders, progress.

    progress.py       where a reader is, from one start to the next
    figure_state.py   a lesson's figure as user edits, stopped repeats, a map
    figure_view.py    what the view shows for a lesson, and what was open before
    shader_copies.py  copies of shaders to break and fix; their files are never written
    bugs.py           a reader's way with such a copy: broken, fixed, edited
    measurements.py   the lesson's numbers, computed while nothing else is to be done
    shelf.py          the lessons that there are
    reader.py         a reader and the lessons: pages, figures, questions and answers
    links.py          where links and buttons lead from a page

Each imports only those above it.
"""
