"""Stage 5: figures and the HTML report."""
