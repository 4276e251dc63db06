"""Keys, mouse, clipboard and drops: what a hand does, and what it means."""
