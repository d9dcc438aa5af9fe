"""The parameter of numerical damping of frequencies that a step cannot resolve."""

from dataclasses import dataclass

from faying.exceptions import ModelError


@dataclass(frozen=True)
class SpectralRadius:
    """The damping parameter of schemes with algorithmic damping.

    Attributes
    ----------
    rho_infinity
        Spectral radius at infinite frequency, 0 (annihilates) to 1 (no damping).
    """

    rho_infinity: float = 0.8

    def __post_init__(self) -> None:
        if not 0.0 <= self.rho_infinity <= 1.0:
            message = f"rho_infinity is {self.rho_infinity:g}; it must lie between 0 and 1"
            raise ModelError(message)
