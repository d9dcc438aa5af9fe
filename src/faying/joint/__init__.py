"""A structure joined to its contact: what full and reduced models are made of."""
