"""Files: atomic writing, reading of untrusted files, and file names."""
