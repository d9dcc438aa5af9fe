"""Strength of bolts: sizes and grades, preloads with scatter, and checks."""
