"""``python -m faying.cli``."""

from faying.cli import main

main()
