"""The page that shows results: the same for the report, which is a file, and for ``review``.

document.py   what the page says of one failed shot, the whole page
report.html   its frame; report.css, its looks
png.js        the exact values of a picture; viewer.js, the panes; report.js, the list and the keys
review.html, review.js    accepting, only in ``review``
"""
