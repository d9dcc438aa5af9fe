"""Stage 3: bases and reduced models."""
