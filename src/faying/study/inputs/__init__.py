"""From a checked study to the model and the loads that are computed."""
