"""Static and transient solutions, the same for full and reduced models (stage 4)."""
