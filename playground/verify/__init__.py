"""Is it still right: ``playground check``, and the fast variants against their canonical forms."""
