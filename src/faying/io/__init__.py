"""Readers and writers, one file per format; readers refuse files by :class:`FormatError`."""
