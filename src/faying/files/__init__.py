"""Files that are complete or absent, and their names."""
