"""Errors, warnings and verdicts of results, and their summary."""
