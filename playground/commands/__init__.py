"""The commands, one a file: each reads its arguments, calls what does the work, and prints."""
