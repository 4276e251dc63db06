"""Lessons as Jupyter notebooks: figures with sliders, code to fix in a cell.

    from playground.course.notebook import open_lesson

    lesson = open_lesson("diamond_square", language="en")
    lesson.show("land")                    # a block by its name: its picture, with sliders
    lesson.fix("without-share", '''…''')  # the picture that other lines of a shader make

Pictures are drawn by the notebook's own Python, without a window. Sliders need the extra
``notebook`` (anywidget); without it each block is a picture, as it is in the lesson.
"""

from playground.course.notebook.lesson import NotebookLesson, open_lesson

__all__ = ["NotebookLesson", "open_lesson"]
