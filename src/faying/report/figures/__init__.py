"""Pictures of models and results: functions that take data and Axes, drawn as pages ask."""
