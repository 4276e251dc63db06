"""A language server for kernels and sketches: what an editor shows while one types.

    server.py       the messages of the protocol, and who answers each
    documents.py    the open texts, saved or not, and positions in them
    checking.py     diagnostics: ``check_file`` on unsaved texts, in the sandbox, stale work given up
    shader.py       what a shader's text names, and where: its includes, parameters, functions
    sketch_text.py  what a place in a sketch's TOML is: which table, which key, which technique
    complete.py     completion; ``complete_toml.py`` that of sketches
    explain.py      hover, go to definition, symbols
    rename.py       rename, where it is safe
    colours.py      colour boxes

What is said comes from the homes that ``check``, the documentation and the engine use; only what the
protocol asks for is made here. pygls, an extra, is imported by ``server`` alone.
"""
