"""How values show themselves: in a line, in a notebook, on axes."""
