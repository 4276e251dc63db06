"""Pages of the site that are generated from the code: commands, techniques, gallery, keys, Python."""
