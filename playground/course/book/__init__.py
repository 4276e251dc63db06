"""The book: lessons as pages that need no network.

build       pictures as WebP, then pages and what the search looks through, into one folder
html        Markdown and formulas as HTML
blocks      each kind of block as HTML
page        the page around them; the contents; the thesis's figures
live        the same for a browser, as data, and the scripts that hold it
book.css    how pages look: narrow and wide, light and dark, on paper
book.js     what moves: sliders, swiping, choices, the start of a live figure; without it everything
            can still be read
find.js     the search, which comes when it is asked for
fonts/      faces of text and formulas, their licences, how they were made
"""
