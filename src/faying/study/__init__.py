"""Study files: schema, run, results."""
