"""Lessons: Markdown with TOML blocks, read into what a window, a book or a notebook shows.

    texts/en/NAME.md    a lesson; all pictures, numbers and code are named there
    texts/fr/NAME.md    its words in another language, and nothing else
    words/              what is written around lessons in each language
    model               what a lesson is made of
    read, fences        from a file to that
    translate           from a translation to that; which of it has gone stale
    library             which lessons and languages there are
    pictures            what is drawn for a lesson
    measuring           what is computed for one, by the functions of ``measures``
    excerpt             code by a named anchor
    rules               what every lesson keeps to
    status              how far translations are
    book/               pages to read offline

Reading needs no OpenGL; an engine is handed to what draws.
"""
