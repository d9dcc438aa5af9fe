"""Results of a run as plain values, and the files that store them."""
