"""A lesson in front of a class: its blocks as beats, each with little to read and one picture.

beat        what is on the screen between two presses of Next
block_beats from a block to its beats
beats       from a lesson to its beats
spoken      what of a text is shown large; how long a beat is read, and its notes as subtitles
slide_text  texts that are laid out by ``typeset``, painted by Pillow; its fonts
slide       the strip below the picture and the board over it, for window and film alike
presenter   which beat is on; ``presented_pictures`` its picture
stage       the presentation in the window: keys, mouse, pen, what is painted
notes       the teacher's page of notes: its server, what it is told (``told``), what it may ask for
film        the presentation as a video with subtitles, without a window
"""
