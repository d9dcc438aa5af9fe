"""Reduction bases and reduced models (stage 3)."""
