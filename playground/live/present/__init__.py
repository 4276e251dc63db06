"""A lesson in front of a class: full screen in the window, or as a film without one.

faces     the fonts, drawn by Pillow
typeset   Markdown with formulas, laid out by Pillow
slide     the strip below the picture and the board over it, for window and film alike
stage     the presentation in the window: keys, mouse, pen, what is painted
film      the presentation as a video with subtitles
"""
