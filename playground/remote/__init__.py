"""Remotes of a window: HTTP and WebSocket, OSC, MIDI. What they may do is ``playground.workbench.control``.

    calls.py     requests of other threads, done by the thread that draws
    server.py    HTTP and WebSocket, in a thread of its own
    page/        the page of sliders that it serves
    osc.py       OSC by UDP
    midi.py      MIDI devices
    remotes.py   those of one window, together

What is not of the standard library is imported when a remote is opened.
"""
