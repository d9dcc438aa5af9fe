"""Figures of models and results, drawn for the pages of a report."""
