"""faying: contact pressure in bolted joints at the cost of a reduced model."""
