"""Strength of bolts: sizes and grades, preloads with their scatter, and what is left of each."""
