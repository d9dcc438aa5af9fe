"""First studies of decks and meshes: what was found, what is guessed, what the user decides."""
