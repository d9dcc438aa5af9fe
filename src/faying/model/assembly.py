"""The contents of a deck: mesh, materials, beams, couplings, supports, nodal loads. Plain values.

An :class:`Assembly` is the common form of every source (generator, deck, matrices) and of every
writer. :func:`faying.joint.build.build_model` turns it into a :class:`faying.Model`.

Each node has six degrees of freedom, translations 0, 1, 2 and rotations 3, 4, 5, in the basic
frame; unused ones are dropped when the model is built.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from faying._typing import Frozen, Indices, Mask, Matrix, SparseMatrix, Vector
from faying.model.material import Material as Material
from faying.model.mesh import Mesh
from faying.model.shells import ShellBlock, ShellSection


@dataclass(frozen=True, kw_only=True)
class BeamSection:
    """Cross-section of a beam.

    Attributes
    ----------
    area : [length²]
    inertia_y, inertia_z : [length⁴]
        Second moments for bending in the local x-z plane and in the local x-y plane.
    torsion : [length⁴]
        Torsion constant J.
    shear_factor_y, shear_factor_z : [-]
        Shear area divided by area in local y and z; ``inf`` is a beam rigid in shear
        (Euler-Bernoulli).
    axial_factor : [-]
        Axial stiffness over E A: nearly 0 for a bolt of prescribed force.
    """

    area: float
    inertia_y: float
    inertia_z: float
    torsion: float
    shear_factor_y: float = np.inf
    shear_factor_z: float = np.inf
    axial_factor: float = 1.0


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A straight two-node beam.

    Attributes
    ----------
    id
        Element id.
    nodes
        Indices of its two nodes.
    orientation : (3,)
        A vector in the local x-y plane.
    """

    id: int
    nodes: tuple[int, int]
    section: BeamSection
    material: Material
    orientation: tuple[float, float, float]
    property: int = 0


@dataclass(frozen=True, kw_only=True)
class Spring:
    """A scalar spring between two degrees of freedom, or from one to ground.

    Attributes
    ----------
    ends
        One or two pairs (node index, component 0..5).
    stiffness : [force/length] or [moment/rad]
    axis
        Two points (x, y, z) on the axis of a shank, if the spring joins a cut through it.
    """

    id: int
    ends: tuple[tuple[int, int], ...]
    stiffness: float
    axis: tuple[tuple[float, ...], tuple[float, ...]] | None = None


@dataclass(frozen=True, kw_only=True)
class ScalarMass:
    """A mass at one degree of freedom, or at the difference of two.

    Attributes
    ----------
    ends
        One or two pairs (node index, component 0..5).
    mass : [mass] or [mass·length²]
    """

    id: int
    ends: tuple[tuple[int, int], ...]
    mass: float


@dataclass(frozen=True, kw_only=True)
class Bush:
    """Six springs between two nodes, or a node and the ground, along given axes.

    Attributes
    ----------
    nodes
        Indices of one node (the other end is grounded) or two.
    stiffness : (6,) [force/length], [moment/rad]
        Along and about the three axes.
    axes : (3, 3)
        Rows are the axes in the basic frame.
    place : (3,) [length]
        Position of the springs, connected to the nodes by rigid arms.
    mass : [mass]
        Mass, divided among the nodes.
    """

    id: int
    nodes: tuple[int, ...]
    stiffness: tuple[float, ...]
    axes: tuple[tuple[float, float, float], ...]
    place: tuple[float, float, float]
    mass: float = 0.0

    @classmethod
    def of_arrays(
        cls,
        number: int,
        nodes: Iterable[int],
        stiffness: Sequence[float] | Mapping[int, float],
        axes: Matrix,
        place: Vector,
        mass: float = 0.0,
    ) -> "Bush":
        """Return a bush from axes (3, 3) and position (3,); stiffness may be given by component."""
        if isinstance(stiffness, Mapping):
            stiffness = [stiffness.get(component, 0.0) for component in range(6)]
        x, y, z = np.asarray(place).tolist()
        rows = tuple((a, b, c) for a, b, c in np.asarray(axes).tolist())
        return cls(
            id=number,
            nodes=tuple(nodes),
            stiffness=tuple(stiffness),
            axes=rows,
            place=(x, y, z),
            mass=mass,
        )


@dataclass(frozen=True, kw_only=True)
class PointMass:
    """A concentrated mass at a node.

    Attributes
    ----------
    mass : [mass]
    inertia : (3, 3) [mass·length²]
        About the centre of the mass.
    offset : (3,) [length]
        From the node to the centre of the mass.
    """

    id: int
    node: int
    mass: float
    inertia: tuple[tuple[float, float, float], ...] = ((0.0,) * 3,) * 3
    offset: tuple[float, float, float] = (0.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class RigidCoupling(Frozen):
    """RBE2: the named components of ``nodes`` follow ``reference`` as one rigid body.

    Attributes
    ----------
    reference
        Index of the independent node, which carries six degrees of freedom.
    nodes : (n,)
        Indices of the dependent nodes.
    components
        Components 0..5 of the dependent nodes that are tied.
    """

    id: int
    reference: int
    nodes: Indices
    components: tuple[int, ...] = (0, 1, 2)


@dataclass(frozen=True, eq=False, kw_only=True)
class AverageCoupling(Frozen):
    """RBE3: ``reference`` moves as the weighted least-squares rigid motion of ``nodes``.

    Attributes
    ----------
    reference
        Index of the dependent node.
    nodes : (n,)
        Indices of the averaged nodes.
    weights : (n,)
    components
        Components 0..5 of ``nodes`` that enter the average.
    reference_components
        Components of the reference node that are tied.
    entering : (n, 6)
        Whether each component of each node enters; None if all do.
    """

    id: int
    reference: int
    nodes: Indices
    weights: Vector
    components: tuple[int, ...] = (0, 1, 2)
    reference_components: tuple[int, ...] = (0, 1, 2, 3, 4, 5)
    entering: Mask | None = None


@dataclass(frozen=True, kw_only=True)
class Equation:
    """MPC: Σ coefficient · u[node, component] = 0; the first term is the dependent one.

    The id is zero if the equation is not from a set of a deck.
    """

    id: int
    terms: tuple[tuple[int, int, float], ...]

    @property
    def label(self) -> str:
        """The name in messages."""
        return f"equation {self.id}" if self.id else "an equation"


@dataclass(frozen=True, eq=False, kw_only=True)
class Support(Frozen):
    """SPC: the named components of ``nodes`` are held at zero.

    Attributes
    ----------
    axes : (3, 3)
        Rows are the directions the components refer to; the basic frame if None.
    """

    id: int
    nodes: Indices
    components: tuple[int, ...]
    axes: Matrix | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class NodalLoads(Frozen):
    """Forces and moments on nodes.

    Attributes
    ----------
    nodes : (n,)
    forces : (n, 6) [force], [force·length]
    """

    nodes: Indices
    forces: Matrix


@dataclass(frozen=True, eq=False, kw_only=True)
class MatrixBlock(Frozen):
    """Mass, damping and stiffness from another program, added to the elements of an assembly.

    Attributes
    ----------
    M, C, K : (n, n)
        Sparse; ``C`` may be None.
    nodes, components : (n,)
        Node index and component 0..5 of each row.
    """

    M: SparseMatrix
    K: SparseMatrix
    nodes: Indices
    components: Indices
    C: SparseMatrix | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Assembly:
    """The structure in a deck, before equations are formed.

    Attributes
    ----------
    mesh
        Nodes and solid elements; without solids where matrices are given.
    materials
        Property id of solids to material.
    shell_sections
        Property id of shells to section.
    element
        Formulation of hex8: ``"incompatible"`` or ``"standard"``.
    face_sets
        Named facets of a deck, or of a model with given matrices: node indices (n_face, n), corners
        first, counter-clockwise seen from outside the body; -1 fills rows with fewer nodes.
    loads
        Load set id (or name) to nodal loads.
    ignored
        Harmless entries that the reader left out, for ``faying check``.
    """

    mesh: Mesh
    materials: Mapping[int, Material] = field(default_factory=dict)
    element: str = "incompatible"
    beams: tuple[Beam, ...] = ()
    shells: tuple[ShellBlock, ...] = ()
    shell_sections: Mapping[int, ShellSection] = field(default_factory=dict)
    springs: tuple[Spring, ...] = ()
    bushes: tuple[Bush, ...] = ()
    masses: tuple[PointMass, ...] = ()
    scalar_masses: tuple[ScalarMass, ...] = ()
    rigid_couplings: tuple[RigidCoupling, ...] = ()
    average_couplings: tuple[AverageCoupling, ...] = ()
    equations: tuple[Equation, ...] = ()
    supports: tuple[Support, ...] = ()
    matrices: MatrixBlock | None = None
    face_sets: Mapping[str, Indices] = field(default_factory=dict)
    loads: Mapping[str, NodalLoads] = field(default_factory=dict)
    name: str = "assembly"
    ignored: tuple[str, ...] = ()

    @property
    def largest_id(self) -> int:
        """Largest id of any element or coupling; they share one numbering in a deck."""
        parts = (
            self.beams,
            self.springs,
            self.bushes,
            self.masses,
            self.scalar_masses,
            self.rigid_couplings,
            self.average_couplings,
        )
        ids = [member.id for family in parts for member in family]
        cells = [*(b.ids for b in self.mesh.blocks), *(b.ids for b in self.shells)]
        ids += [int(block.max()) for block in cells if len(block)]
        return max(ids, default=0)
