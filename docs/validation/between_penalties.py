"""The seed's study at penalties between those of its table: where its two bounds hold together.

``python docs/validation/between_penalties.py [OUT.md]``
prints and writes the table (four minutes).
"""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[2] / "examples"))

import seed_reproduction

PENALTIES = (2e4, 3e4, 5e4)


def main() -> None:
    """Print the table, and write it where a file is named."""
    model = seed_reproduction.joint()
    rows = [row for penalty in PENALTIES for row in seed_reproduction.rows(model, penalty)]
    text = seed_reproduction.table(rows)
    sys.stdout.write(text)
    if len(sys.argv) > 1:
        Path(sys.argv[1]).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
