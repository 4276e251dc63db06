"""Comparing the pictures that sketches promise with their references, by hand or in pytest.

    compare.py      two arrays → a verdict, how much, how many, where
    flip.py         two arrays → how different they look
    fingerprint.py  what a picture comes from: which build of which renderer drew what
    references.py   where references live; reading, writing, finding those that nothing uses
    judge.py        a picture and its references → whether it passes, by which tier, and why
    suite.py        sketches → cases → frames → outcomes
    results.py      a folder with a record of each checked shot and its pictures
    page/           what shows them, as HTML
    report.py       one file of a folder of results, with no network
    accept.py       a picture of them becomes a reference; undoing that
    session.py      what is reviewed: accepted, undone, changed meanwhile
    review.py       the same page, served on this machine alone
    studio.py       a child process with the software renderer, which takes the pictures
    plugin.py       pytest: options, the ``shots`` fixture, what a failure prints

Each knows only those above it. Importing this opens nothing.
"""
