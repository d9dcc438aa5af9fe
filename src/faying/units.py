"""What the quantities of a run are measured in, from the label of a consistent unit set."""

from dataclasses import dataclass

# Force and pressure that length-mass-time sets imply, F = m l / t², p = F / l².
DERIVED = {
    "mm-t-s": ("N", "MPa"),
    "mm-kg-ms": ("kN", "GPa"),
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

    def of(self, dimension: str) -> str:
        """Return the unit of a dimension such as ``"force/length³"``; ``"1"`` has none."""
        if dimension == "force/length²":
            return self.pressure
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
