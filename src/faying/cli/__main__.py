"""``python -m faying.cli``."""

from faying.cli import main

# Worker processes read this module again under another name.
if __name__ == "__main__":
    main()
