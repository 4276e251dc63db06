"""What feeds the channels of another tool's shader."""
