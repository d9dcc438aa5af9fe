"""What a reader can turn, zoom and point at in a report: its data, and the scripts that draw it."""
