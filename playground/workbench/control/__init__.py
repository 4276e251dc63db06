"""Drive a session from outside of its window: the one seam for every remote, without a network or a window.

    items.py            the parameters that there are, by path
    described.py        what there is to control, as JSON
    controls.py         sets values, time, presets; undoes; takes the picture
    addresses.py        an address of OSC → a parameter, or one part of it
    shares.py           a fraction of a widget's range ↔ a value
    controllers.py      knobs and buttons of MIDI devices → values, learned
    controller_file.py  the file that remembers them
    changes.py          what has changed since the last look, for those who listen

All of it belongs to the thread that draws; ``playground.remote`` brings requests there.
"""
