"""From a study file to a folder of results."""
