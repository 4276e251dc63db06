"""The land: how high and lit it is shown, its metres, its looks and the views of it."""
