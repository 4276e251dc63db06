"""Comparing the pictures that sketches promise with their references, by hand or in pytest.

    plugin_constants.py    folders, and what tests report to the plugin
    compare.py      two arrays → a verdict, how much, how many, where; masks; flip.py: as an eye sees it
    references.py   where references live, what they come from, whose replace whose
    judge.py        a picture, its fingerprint, references → whether it passes, in a word; films, frame by
    frame suite.py        sketches → cases → frames, drawn in a worker → outcomes results.py      a folder
    with a record of each checked shot and its pictures page/           what shows them, as HTML report.py
    one file of a folder of results, with no network; the page of a workflow's run accept.py       a picture
    of them becomes a reference; undoing that review.py       the same page, served on this machine alone
    names.py        names of pictures after their tests; each for one test of a run recording.py,
    checking.py    draw, compare, write, and say it, for one process of pytest pictures.py     a picture
    from whatever holds one, as bytes; masks of tests collect.py, fixture.py      tests from sketches; the
    ``shot`` fixture of tests in Python plugin.py       pytest: options, which sketches, the summary,
    references that nothing uses mutants/        images broken on purpose, that no comparison may let pass

Each knows only those above it. Importing this opens nothing.
"""
