"""What is wrong with a sketch: errors, warnings, numbers that are not finite."""
