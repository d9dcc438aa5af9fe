"""Component digits such as 123 or 246."""

from collections.abc import Callable

from faying.exceptions import FormatError


def components(digits: str, error: Callable[[str], FormatError]) -> tuple[int, ...]:
    """Return components 0..5, ascending, of digits 1..6."""
    if not digits or set(digits) - set("123456") or len(set(digits)) != len(digits):
        shown = f"'{digits}'" if digits else "nothing"
        message = f"components are {shown}; expected distinct digits 1 to 6, such as 123"
        raise error(message)
    return tuple(sorted(int(digit) - 1 for digit in digits))


def digits_of(numbers: tuple[int, ...]) -> str:
    """Return digits 1..6 of components 0..5."""
    return "".join(str(number + 1) for number in sorted(numbers))


def frame_independent(numbers: tuple[int, ...]) -> bool:
    """Whether translations and rotations each enter all or not at all.

    Then the components span the same space in any node's coordinate system.
    """
    return all(len(set(numbers) & group) in (0, 3) for group in ({0, 1, 2}, {3, 4, 5}))
