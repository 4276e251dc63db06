"""A live session without a window: drafts, user edits, history, painting, inspection, lessons.

    clock.py            the sketch's own time: runs, rests, never jumps
    dependencies.py     which files a sketch depends on
    watcher.py          which of them have changed
    edit_merge.py       whether the user's value or the file's counts
    edits.py            user edits, and how they survive a change of the files
    last_frame.py       the last good picture, and a texture put on a screen
    maps.py             any texture of a sketch, shown from above
    resume.py           edits of an earlier session, over the files of now
    reload_stages.py    the stages that a saved sketch goes through, and who tries it
    drafts.py           what the files say, what was changed, what is wrong; draws nothing
    session.py          the sketch as it is shown: its picture, a map, time
    reload.py           a session and its files kept together
    memory.py           the file that remembers one sketch
    autosave.py         what a session shows, remembered as one goes
    brush.py, painted_mask.py, painting.py   strokes on a mask, its file, the brush over the picture
    actions.py          what a button or a key asks for that is more than one call of the session
    inspect/            numbers, costs, comparisons, the pass graph, time
    lesson/             a reader and the lessons

Nothing here imports a window: a test, a notebook or another interface can drive all of it.
"""
