"""Make terrain that looks like a piece of real terrain."""
