"""The study file: its tables, what they must be alone and together, and reading it."""
