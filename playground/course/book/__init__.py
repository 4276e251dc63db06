"""The book: lessons as pages that need no network."""
