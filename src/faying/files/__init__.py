"""Files: written complete or not at all, read where they fit in memory, and their names."""
