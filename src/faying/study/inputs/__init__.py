"""From a checked study to its model and loads."""
