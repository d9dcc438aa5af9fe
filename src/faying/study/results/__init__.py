"""What a run leaves, as plain values, and the file that keeps them."""
