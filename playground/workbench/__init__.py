"""A live session without a window: drafts, user edits, history, painting, inspection.

    session.py          the sketch as it is shown: it has the five below
      drafts.py         what the files say, the user's edits, what is wrong
      pending.py        techniques and data files that are checked before they are shown
      view.py           a map instead of the sketch's own view, repeats stopped early
      clock.py          the sketch's own time
      data_files.py     which data files have been drawn with
    edits.py, edit_merge.py, resume.py   user edits over files that change, and over a restart
    reload_stages.py    the stages that a saved sketch goes through, and its errors
    dependencies.py, watcher.py, reload.py   the files of a sketch, and what changes in them
    notices.py          sentences on the screen
    history.py, undo.py   steps, and applying them
    commands.py, sketch_file.py, keyframe_edits.py   presets, resets, saving, keyframes
    open_files.py, editors.py, text_file.py   files open in an editor
    captures.py         PNGs, large pictures, films
    painting.py         the brush over the picture
      brush.py          where a stroke reaches, and masks
      sculpting.py      the brushes of numbers
      layer.py          an image that is painted on, its file and its strokes undone
      latest_write.py   a file written on a thread
      erode_tool.py     the tool that runs a technique
    interface.py        which panels are shown, and how large
    memory.py, autosave.py   the file that remembers one sketch, written as one goes
    inspect/            numbers, costs, comparisons, the pass graph, time
    bench.py            all of it put together
    addition.py         what rooms that can be removed add to it and its window

Nothing here imports a window: a test, a notebook or another interface can drive all of it.
"""
