"""Worker processes: what draws or compiles for another process, so that what kills it kills nothing else."""
