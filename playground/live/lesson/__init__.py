"""Lessons in the live window: a panel of text next to the picture, which is the live view itself.

    labels.py           what is written around lessons, in each language
    markdown_runs.py    Markdown as runs of one style
    line_breaking.py    runs broken into lines
    formulas.py         LaTeX as textures
    prose.py            layout and drawing of texts
    page.py             what every block is drawn with
    figure_blocks.py, questions.py, code_blocks.py   the blocks
    panel.py            the panel
    host.py             what the window asks of all that

Each imports only those above it; a reader without a window is in ``workbench.lesson``.
"""
