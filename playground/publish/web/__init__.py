"""Sketches as web pages: the plan as data, and a runtime that runs it in WebGL2.

What Python knows (passes, headers, sizes, widgets) is written down as JSON; ``runtime/schema.js`` says
what of it is where. ``runtime/`` is plain JavaScript, checked by TypeScript, bundled by esbuild.
"""
