"""See inside a kernel: every value of one texel, by line, call and iteration.

``model`` is what a trace is, ``listing`` its text beside the source, ``instrument`` writes the shader that
records, and ``tracer`` draws it behind the picture.
"""
