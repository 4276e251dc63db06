"""Hand out the exercises of lessons as a zip: a page to read, and for each exercise what a student edits."""
