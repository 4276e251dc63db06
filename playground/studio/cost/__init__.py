"""What each pass costs, and why it ran."""
