"""How fast the playground is, next to what else does the same: ``playground bench``."""
