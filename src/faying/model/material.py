"""Linear elastic materials of solids, beams and shells."""

from dataclasses import dataclass, replace
from typing import Protocol

from faying._typing import Matrix
from faying.exceptions import refuse_model
from faying.model.elastic_law import Law, as_law, mean_constants, stable


@dataclass(frozen=True, kw_only=True)
class Material:
    """Linear elastic material.

    Attributes
    ----------
    youngs_modulus : [force/length²]
    poissons_ratio : [-]
    density : [mass/length³]
    law : (6, 6) [force/length²]
        Anisotropic stiffness in the basic frame, see :mod:`faying.model.elastic_law`; E and ν are
        then its means, which scale contact. None if isotropic.
    expansion : [1/temperature]
        Coefficient of thermal expansion α; None if unknown.

    Examples
    --------
    >>> import faying as fy
    >>> steel = fy.Material(youngs_modulus=210e3, poissons_ratio=0.3, density=7.85e-9)
    >>> fy.lap_joint(element_size=5.0, material=steel).units
    'mm-t-s'
    """

    youngs_modulus: float
    poissons_ratio: float
    density: float
    name: str = ""
    law: Law | None = None
    expansion: float | None = None

    def __post_init__(self) -> None:
        label = f"material '{self.name}'" if self.name else "material"
        if not self.youngs_modulus > 0:
            refuse_model(
                f"{label}: Young's modulus is {self.youngs_modulus:g}; it must be positive"
            )
        if not -1 < self.poissons_ratio < 0.5:
            refuse_model(
                f"{label}: Poisson's ratio is {self.poissons_ratio:g}; "
                "it must lie strictly between -1 and 0.5"
            )
        if not self.density >= 0:
            refuse_model(f"{label}: density is {self.density:g}; it must not be negative")

    @classmethod
    def anisotropic(cls, law: Law | Matrix, *, density: float, name: str = "") -> "Material":
        """Return an anisotropic material from its stiffness (6, 6).

        Raises
        ------
        ModelError
            If the stiffness is not symmetric, or not positive definite.
        """
        if not stable(law):
            label = f"material '{name}'" if name else "material"
            refuse_model(
                f"{label}: its elastic constants are not those of a stable material; the stiffness "
                "must be symmetric and positive definite"
            )
        modulus, ratio = mean_constants(law)
        return cls(
            youngs_modulus=modulus,
            poissons_ratio=ratio,
            density=density,
            name=name,
            law=as_law(law),
        )

    @property
    def shear_modulus(self) -> float:
        """G = E / (2 (1 + ν)) [force/length²]."""
        return self.youngs_modulus / (2 * (1 + self.poissons_ratio))


class MaterialWishes(Protocol):
    """Material constants in a study; None keeps the constant of the source."""

    @property
    def E(self) -> float | None:
        """Young's modulus [force/length²]."""

    @property
    def nu(self) -> float | None:
        """Poisson's ratio."""

    @property
    def rho(self) -> float | None:
        """Density [mass/length³]."""

    @property
    def alpha(self) -> float | None:
        """Coefficient of thermal expansion [1/temperature]."""


def overridden(material: Material, wishes: MaterialWishes) -> Material:
    """Return a material with the constants of a study; E or nu make it isotropic."""
    return replace(
        material,
        law=material.law if wishes.E is None and wishes.nu is None else None,
        youngs_modulus=material.youngs_modulus if wishes.E is None else wishes.E,
        poissons_ratio=material.poissons_ratio if wishes.nu is None else wishes.nu,
        density=material.density if wishes.rho is None else wishes.rho,
        expansion=material.expansion if wishes.alpha is None else wishes.alpha,
    )
