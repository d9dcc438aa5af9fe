"""The classic basis [Ψ_c Φ_n], Eq. (15.18) (Craig & Bampton 1968, doi:10.2514/3.4741)."""

from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.normal_modes import NormalModes, fixed_interface_normal_modes


def craig_bampton(model: Model, *, normal_modes: int = 20) -> Basis:
    """Return constraint modes, fixed-interface normal modes, a shape per bolt and load pattern.

    The shape of a bolt, or of a load pattern, is the static response to a unit initial force, or
    load, with the boundary held. Any preload is then represented exactly, by every method. A free
    structure has the shapes of (M12) besides.

    Parameters
    ----------
    model
        Usually preloaded, with its sticking area.
    normal_modes
        Number of fixed-interface normal modes.

    Returns
    -------
    Basis
        Boundary rows are [I 0]; the shapes that vanish there are orthonormal in K.

    Notes
    -----
    One back-substitution per boundary degree of freedom, bolt and load pattern, and one Lanczos
    run, all with one factorization.

    Examples
    --------
    >>> import faying as fy
    >>> fy.craig_bampton(fy.lap_joint(element_size=5.0), normal_modes=4)
    Basis(trial vectors: 11 (6 constraint, 4 normal, 1 bolt), degrees of freedom: 1326)
    """
    return classic_basis(model, fixed_interface_normal_modes(model.structure, normal_modes))


def classic_basis(model: Model, modes: NormalModes) -> Basis:
    """Return the basis of :func:`craig_bampton` with normal modes already computed."""
    structure = model.structure
    classic = (
        Basis(
            vectors=structure.constraint_modes,
            kinds=(ModeKind.CONSTRAINT,) * len(structure.boundary),
        )
        + Basis(vectors=modes.vectors, kinds=(ModeKind.NORMAL,) * len(modes.frequencies))
        + Basis(vectors=structure.bolt_shapes, kinds=(ModeKind.BOLT,) * len(model.bolts))
        + Basis(
            vectors=structure.solve_held(model.pattern_forces.T),
            kinds=(ModeKind.LOAD,) * len(model.load_patterns),
        )
        + Basis(
            vectors=structure.relief_shapes,
            kinds=(ModeKind.RELIEF,) * structure.relief_shapes.shape[1],
        )
    )
    return classic.orthonormalized(structure.supported_stiffness)
