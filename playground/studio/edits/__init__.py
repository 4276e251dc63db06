"""Drafts, user edits over files that change, undo, and what is remembered of a sketch."""
