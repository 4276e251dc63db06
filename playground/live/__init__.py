"""The live window: the only place with a window, keys and a wall clock.

    clock.py      the sketch's own time: runs, rests, never jumps
    files.py      which files a sketch stands on
    watch.py      which of them have changed
    words.py      whether the hand's value or the file's counts
    edits.py      what a person changed by hand, and how it survives a change of the files
    picture.py    the last good picture, and a texture put on a screen
    maps.py       any texture of a sketch, shown from above
    begin.py      what was set by hand in an earlier session, over the files of now
    stages.py     the stages a saved sketch goes through, and who tries it
    drafts.py     what the files say, what was changed, what is wrong; draws nothing
    session.py    the sketch as it is seen: its picture, a map, time; knows of no window
    follow.py     a session and its files kept together
    memory.py     the file that remembers one sketch
    remember.py   what a session shows, remembered as one goes
    pictures.py   a picture saved under a new name
    brush.py      a stroke on a mask
    canvas.py     a mask that is painted on, and its file
    painting.py   the brush over the picture: which mask, which place of the land
    see/          what the window shows beside the picture: numbers, costs, comparisons, time
    actions.py    what a button or a key asks for that is more than one call of the session
    status.py     what the window shows, as JSON lines for another program

    lesson/       lessons: a panel of text, and the picture as their figure

    theme.py      fonts, colours, margins
    window.py     GLFW, an OpenGL context, Dear ImGui: the one place that knows of screens
    dividers.py   the lines that part a picture, moved by the mouse
    gesture.py    a drag over the picture → a camera
    keys.py       the table of keys, which the key map shows as well

    numbers.py    how a number is written, and what a drag makes of it
    dome.py       the sky as a disc, for a direction
    widgets.py    one control for each row of ``sketch/widgets.py``
    rows.py       a line of the panel: a label, a control
    costs.py      the table of what the picture cost
    paintbox.py   the brush's controls
    panel.py      all of that, made from the sketch's annotations
    excerpt.py    an offending line, cut so that it fits
    overlay.py    errors and notices over the picture
    hand.py       the mouse over the picture: what it turns, moves or paints
    app.py        opens a sketch in a window and ties everything above together

Each knows only those above it. Importing this opens nothing.
"""
