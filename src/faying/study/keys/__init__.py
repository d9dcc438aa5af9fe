"""The study file: its tables, their checks, and its reader."""
