"""Interfaces: facets, pairs and projections of two surfaces, and the operators between them."""
