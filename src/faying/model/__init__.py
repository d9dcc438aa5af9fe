"""Stage 1: from a deck, a generator or matrices to M, C, K."""
