"""The 3-D view of a report: its data, and the scripts that draw it."""
