"""The classic basis [Ψ_c Φ_n], Eq. (15.18) (Craig & Bampton 1968, doi:10.2514/3.4741)."""

from faying.joint.model import Model
from faying.reduction.basis import Basis, ModeKind
from faying.reduction.normal_modes import NormalModes, fixed_interface_normal_modes


def craig_bampton(model: Model, *, normal_modes: int = 20) -> Basis:
    """Constraint modes, fixed-interface normal modes, one shape per bolt and load pattern.

    The seed counts the bolt's pretension among the boundary forces. Here a bolt is one inner
    spring, so its place is taken by the static shape of a unit initial force with the boundary
    held: any preload is then represented exactly, by every method. A load pattern has its static
    shape for the same reason.

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
    )
    return classic.orthonormalized(structure.K)
