"""Versions of a sketch: kept by themselves at each good save, looked at, compared, named, gone back to."""
