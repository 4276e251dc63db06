"""A language server: what an editor shows in kernels and sketches while one types.

    server.py       the messages of the protocol, and the answer of each
    documents.py    open texts, saved or not; diagnostics by ``check_file`` in the sandbox
    names.py        the names in GLSL texts, and what each means
    shader.py       what is known of a shader; ``sketch_text.py`` of a sketch's TOML
    complete.py     completion
    explain.py      hover, definitions, symbols, colour boxes; ``describe.py`` writes them as Markdown
    rename.py       rename, where it is safe, and references
    highlight.py    what a name can change, what nothing names, the kind of each name
    traced.py       the values of a texel beside the code, by ``trace_worker.py`` in a process of its own

Facts come from where ``check``, the documentation and the engine have them. Needs the core, ``verify`` for
``check_file``, and pygls (extra ``lsp``), which ``server`` alone imports. To delete it: this folder,
tests/lsp and its line in rooms.py.
"""
