"""Stage 2: where the parts touch, and the complementarity problem of contact."""
