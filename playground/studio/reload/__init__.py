"""Watch the files of a sketch and follow them."""
