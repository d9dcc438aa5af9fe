"""What the quantities of a run are measured in, from the label of a consistent unit set."""

from dataclasses import dataclass

# Force and pressure that length-mass-time sets imply, F = m l / t², p = F / l².
DERIVED = {
    "mm-t-s": ("N", "MPa"),
    "mm-kg-ms": ("kN", "GPa"),
    "mm-kg-s": ("mN", "kPa"),
    "mm-g-ms": ("N", "MPa"),
    "m-kg-s": ("N", "Pa"),
    "cm-g-s": ("dyn", "Ba"),
    "in-slinch-s": ("lbf", "psi"),
    "ft-slug-s": ("lbf", "psf"),
}


KINDS_OF_UNITS = {
    "a length": ("m", "dm", "cm", "mm", "um", "µm", "in", "ft"),
    "a mass": ("kg", "g", "mg", "t", "Mg", "slug", "slinch", "lb", "lbm"),
    "a time": ("s", "ms", "us", "µs", "min", "h"),
    "a force": ("N", "mN", "kN", "MN", "daN", "dyn", "lbf", "kgf"),
    "a pressure": ("Pa", "kPa", "MPa", "GPa", "bar", "psi", "ksi", "psf"),
}
"""Names of units whose kind is known; a study may use others."""


# In m, kg and s; slug and slinch by the international pound, foot and inch (NIST SP 811, App. B).
LENGTHS = {"m": 1.0, "dm": 0.1, "cm": 1e-2, "mm": 1e-3, "um": 1e-6, "in": 0.0254, "ft": 0.3048}
MASSES = {
    "kg": 1.0,
    "g": 1e-3,
    "mg": 1e-6,
    "t": 1e3,
    "Mg": 1e3,
    "slug": 14.5939029372064,
    "slinch": 175.126835246476,
}
TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "min": 60.0, "h": 3600.0}
FREQUENCIES = {"s": "Hz", "ms": "kHz", "us": "MHz", "µs": "MHz"}


@dataclass(frozen=True, kw_only=True)
class Units:
    """Names of units.

    Attributes
    ----------
    length, mass, time, force, pressure
        As they stand behind a number; "force" and "force/length²" where the set is not a
        known one.
    """

    length: str
    mass: str
    time: str
    force: str
    pressure: str

    @property
    def frequency(self) -> str:
        """Cycles in a unit of time: 1/s might be read as radians in a second."""
        return FREQUENCIES.get(self.time, f"1/{self.time}")

    def of(self, dimension: str) -> str:
        """Return the unit of a dimension such as ``"force/length³"``; ``"1"`` has none."""
        if dimension == "force/length²":
            return self.pressure
        if dimension == "1/time":
            return self.frequency
        text = dimension
        for name in ("length", "mass", "time", "force"):
            text = text.replace(name, getattr(self, name))
        return text


def units_of(label: str) -> Units:
    """Return the units of a set named length-mass-time.

    Examples
    --------
    >>> units_of("mm-t-s").pressure
    'MPa'
    """
    parts = label.split("-")
    length, mass, time = parts if len(parts) == 3 else ("length", "mass", "time")
    force, pressure = DERIVED.get(label, ("force", "force/length²"))
    return Units(length=length, mass=mass, time=time, force=force, pressure=pressure)


def pascals(label: str) -> float | None:
    """Return how many pascals the unit of pressure of a set is; None where a unit is not known.

    Examples
    --------
    >>> round(pascals("mm-t-s"))
    1000000
    """
    length, mass, time = label.split("-") if label.count("-") == 2 else ("", "", "")
    if length not in LENGTHS or mass not in MASSES or time not in TIMES:
        return None
    return MASSES[mass] / (LENGTHS[length] * TIMES[time] ** 2)
