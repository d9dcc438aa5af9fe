"""Numbers as text: a few significant digits, a unit, no false precision."""

import numpy as np

from faying._typing import Vector
from faying.digits import SOLVED


def number(value: float, digits: int = 3) -> str:
    """Return a number with some significant digits, in scientific form if very large or small.

    Examples
    --------
    >>> number(10463.95), number(2.5e-4), number(0.0), number(1.6e24)
    ('10500', '2.50e-4', '0', '1.60e24')
    """
    if not np.isfinite(value):
        return "∞" if value > 0 else ("−∞" if value < 0 else "not a number")
    if value == 0:
        return "0"
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    power = int(exponent)
    if -3 < power < digits + 3:
        return _plain(float(f"{value:.{digits - 1}e}"), max(digits - 1 - power, 0))
    return f"{mantissa}e{power}".replace("-", "−", 1 if value < 0 else 0)


def as_given(value: float, digits: int = 5) -> str:
    """Return a number of a study as :func:`number` does, without zeros that end its decimals.

    Examples
    --------
    >>> as_given(640.0), as_given(6.4e8), as_given(0.05), as_given(40e3)
    ('640', '6.4e8', '0.05', '40000')
    """
    mantissa, e, power = number(value, digits).partition("e")
    return (mantissa.rstrip("0").rstrip(".") if "." in mantissa else mantissa) + e + power


def _plain(value: float, decimals: int) -> str:
    return f"{value:.{decimals}f}".replace("-", "−")


def quantity(value: float, unit: str, digits: int = 3) -> str:
    """Return a number with its unit.

    Examples
    --------
    >>> quantity(105.4037, "MPa")
    '105 MPa'
    """
    return f"{number(value, digits)} {unit}".rstrip()


def percent(fraction: float) -> str:
    """Return a fraction in percent; values below solver accuracy become a bound.

    Examples
    --------
    >>> percent(0.0423), percent(4.07), percent(1e-12)
    ('4.2 %', '407 %', '< 1e-7 %')
    """
    size = abs(fraction)
    if 0 < size < SOLVED:
        return f"< {100 * SOLVED:.0e} %".replace("e-0", "e-")
    return f"{number(100 * fraction, 3 if size >= 1 else 2)} %"


def seconds(value: float) -> str:
    """Return a wall time in s or ms.

    Examples
    --------
    >>> seconds(0.00123), seconds(75.2)
    ('1.23 ms', '75.2 s')
    """
    return quantity(1e3 * value, "ms") if 0 < abs(value) < 0.1 else quantity(value, "s")


def place(point: Vector, unit: str, scale: float) -> str:
    """Return coordinates as text, rounded to a thousandth of a length scale.

    Examples
    --------
    >>> place(np.array([52.0, 4.25, 1e-14]), "mm", 40.0)
    '(52, 4.25, 0) mm'
    """
    decimals = max(0, 2 - int(np.floor(np.log10(scale)))) + 1 if scale > 0 else 3
    texts = (f"{value + 0.0:.{decimals}f}" for value in np.round(point, decimals) + 0.0)
    short = (text.rstrip("0").rstrip(".") if "." in text else text for text in texts)
    return f"({', '.join(short)}) {unit}".replace("-", "−")
