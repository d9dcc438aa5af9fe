"""Solid elements, one file each."""
