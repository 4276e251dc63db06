"""The book: lessons as pages that need no network.

build       pictures, then pages, into one folder
images      every picture of every lesson, as WebP
html        Markdown and formulas as HTML
blocks      each kind of block as HTML
page        the page around them; the contents
live_scenes, live_blocks, live_tasks, live_files
            the same for a browser, as data, and the scripts that hold it
search      what the search looks through
gallery     the page of the thesis's figures
book.css    how pages look: narrow and wide, light and dark, on paper
book.js     what moves: sliders, swiping, choices, the start of a live figure; without it everything
            can still be read
find.js     the search, which comes when it is asked for
fonts/      faces of text and formulas, their licences, how they were made
"""
