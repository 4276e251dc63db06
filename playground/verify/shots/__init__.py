"""Comparing the pictures that sketches promise with their references, by hand or in pytest.

    plugin_constants.py    folders, and what tests report to the plugin
    compare.py      two arrays → a verdict, how much, how many, where; flip.py: as an eye sees it
    masking.py, tolerated.py    what is not compared; what a shot lets differ, and what no tolerance may
    fingerprint.py  what a picture comes from
    references.py   where references live; reading, writing, finding those that nothing uses
    judge.py        a picture, its fingerprint, references → whether it passes, in a word
    strip.py        a few frames of a film as one picture, judged frame by frame
    suite.py        sketches → cases → frames → outcomes
    results.py      a folder with a record of each checked shot and its pictures
    result_paths.py    where in that folder each has its own; removing what is out of date
    page/           what shows them, as HTML
    report.py       one file of a folder of results, with no network
    accept.py       a picture of them becomes a reference; undoing that
    review_session.py    what is reviewed: accepted, undone, changed meanwhile
    review.py       the same page, served on this machine alone
    renderer_process.py    render shots in a worker process
    recording.py, checking.py    draw, compare, write, and say it, for one process of pytest
    adapters.py, levels.py      a picture from whatever holds one; its numbers as bytes
    names.py, claims.py         names of pictures after their tests; each for one test of a run
    soft_failures.py            a test fails at its end, for all its pictures
    collect.py, fixture.py      tests from sketches; the ``shot`` fixture of tests in Python
    mask_of_test.py             the masks that those give
    properties.py, step_summary.py    what a test tells ``--junitxml``, and the page of a workflow's run
    fallbacks.py    whose references replace which renderer's
    unused_references.py    references of tests in Python that none uses any more
    plugin.py       pytest: options, which sketches, the summary
    mutants/        images broken on purpose, that no comparison may let pass

Each knows only those above it. Importing this opens nothing.
"""
