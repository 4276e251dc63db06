"""A language server: what an editor shows in kernels and sketches while one types.

    server.py       the messages of the protocol, and the answer of each
    documents.py    open texts, saved or not; diagnostics by ``check_file`` in the sandbox
    shader.py       the names in a shader's text, and what each means; ``sketch_text.py`` those in a sketch
    complete.py     completion
    explain.py      hover, definitions, symbols, colour boxes; ``describe.py`` writes them as Markdown
    rename.py       rename, where it is safe, and references
    highlight.py    what a name can change, what nothing names, the kind of each name
    traced.py       the values of a texel beside the code, by ``trace_worker.py`` in a process of its own

Facts come from where ``check``, the documentation and the engine have them. Needs the core, ``verify`` for
``check_file``, and pygls (extra ``lsp``), which ``server`` alone imports. To delete it: this folder,
tests/lsp and its line in rooms.py.
"""
