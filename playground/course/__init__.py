"""Lessons: Markdown with TOML blocks, read into what a window, a book or a notebook shows.

    texts/en/NAME.md    a lesson; all pictures, numbers and code are named there
    texts/fr/NAME.md    its texts in another language, and nothing else
    labels/             all labels, a catalogue a language; ``language`` reads them
    model               what a lesson is made of
    document            a file split into front matter and pieces
    read, fences        from a file to a lesson; ``task_fences`` of what a student does
    translate           from a translation to a lesson; what of it is out of date
    library             which lessons and languages there are, and their order
    figure_renders      the pictures of a lesson
    figures             the thesis's figures, and those at the heads of lessons
    measuring           the numbers of a lesson, by the functions of ``measures``
    excerpt             code by a named anchor; the lines around a deliberate bug
    rules               the rules of every lesson
    typeset             Markdown laid out for the window's panel and for slides; as HTML, in ``book.html``
    tasks/              exercises that check themselves, and pictures to match
    exercises/          their starters and model answers
    book/               pages to read offline
    notebook/           Jupyter notebooks
    handout/, grading/  exercises given out as a zip; what a class has handed in, graded
    window/             lessons next to the live picture
    talk/               a lesson in front of a class
    commands, options, addition, site   what the room adds to the rest (``playground.rooms``)

Reading needs no OpenGL; what draws receives an engine.
"""
