"""A first study of a deck or mesh: what is there, what can be guessed, what must be decided."""
