"""Lay out one card in small (8 columns) or large (16 columns) fields."""

from collections.abc import Sequence

from faying.io.nastran.fields import format_real

Value = int | float | str | None


def small(name: str, values: Sequence[Value]) -> str:
    """Return the lines of a card with eight data fields of eight columns each."""
    texts = [_text(value, 8).ljust(8) for value in values]
    lines = [
        f"{name if i == 0 else '+':8}{''.join(texts[i : i + 8])}".rstrip()
        for i in range(0, max(len(texts), 1), 8)
    ]
    return "\n".join(lines)


def large(name: str, values: Sequence[Value]) -> str:
    """Return the lines of a card with four data fields of sixteen columns each.

    Lines come in pairs, as Nastran demands.
    """
    texts = [_text(value, 16).ljust(16) for value in values]
    texts += [" " * 16] * (-len(texts) % 8)
    lines = [
        f"{name + '*' if i == 0 else '*':8}{''.join(texts[i : i + 4])}".rstrip()
        for i in range(0, len(texts), 4)
    ]
    return "\n".join(lines)


def _text(value: Value, width: int) -> str:
    if value is None:
        return ""
    return format_real(value, width) if isinstance(value, float) else str(value)
