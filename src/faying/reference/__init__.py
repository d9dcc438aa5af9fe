"""Exact answers to small contact problems, for tests, documentation and the curious."""
