"""The full finite element model of a joint."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

from faying._typing import Mask, Matrix, SparseMatrix, Vector
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import Curve, Law
from faying.display.facts import Shown, counted
from faying.exceptions import check_known, naming, refuse_model
from faying.interface.interface import Interface, stack
from faying.interface.penalty import TangentialPenalty, with_friction
from faying.joint.load_pattern import (
    LoadPattern,
    check_pattern_name,
    load_pattern,
    pattern_forces,
)
from faying.joint.structure import Structure
from faying.joint.system import PortCompliance, static_contact_of
from faying.joint.weak_support import WeakSupport
from faying.linalg.interface import Factorization
from faying.model.assembly import Assembly, NodalLoads
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary
from faying.model.dofs import DofMap
from faying.model.matrices import assemble_matrices
from faying.model.specs import Rayleigh


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class Model(Shown):
    """A structure with interfaces, bolts, boundaries and load patterns.

    Copies made by the ``with_…`` methods share the structure, and with it all results of its
    factorization.

    Attributes
    ----------
    structure
        M, C, K and the results of their factorization.
    interfaces, bolts, boundaries
        By name.
    dofs
        Map from the six degrees of freedom of every node to the free ones.
    assembly
        The description from which the model was built.
    units
        Label of the consistent unit set, repeated in every output.
    stuck
        Interface name to the pairs (n_pair,) that stick in tangential direction.
    stuck_stiffness : [force/length]
        Stiffness of the springs of each pair; zero where nothing sticks, or it is unknown.
    load_patterns
        Distributed loads that may be scaled; none by default, since each costs a port.
    weak_supports
        Springs for bodies that contact alone holds, by the names of both bodies.

    Examples
    --------
    >>> import faying as fy
    >>> fy.lap_joint(element_size=5.0).K.shape
    (1326, 1326)
    """

    structure: Structure
    interfaces: Mapping[str, Interface]
    bolts: Mapping[str, Bolt]
    boundaries: Mapping[str, Boundary]
    dofs: DofMap
    assembly: Assembly
    name: str = "model"
    units: str = "mm-t-s"
    stuck: Mapping[str, Mask] = field(default_factory=dict)
    stuck_stiffness: float = 0.0
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)
    weak_supports: Mapping[str, WeakSupport] = field(default_factory=dict)

    @property
    def facts(self) -> Mapping[str, str]:
        """Name, size and parts."""
        mesh = self.assembly.mesh
        return {
            "name": self.name,
            "nodes": str(len(mesh.nodes)),
            "solid elements": str(mesh.n_elements),
            "free degrees of freedom": str(self.structure.n_dof),
            "interfaces": counted(self.interfaces),
            "bolts": counted(self.bolts),
            "boundaries": counted(self.boundaries),
            "units": self.units,
        }

    def plot(self, axes: Any = None) -> Any:
        """Draw bodies, interfaces, boundaries and supports.

        Parameters
        ----------
        axes
            Axes of matplotlib, in three dimensions; new ones by default.

        Returns
        -------
        Axes3D
        """
        from faying.joint.picture import plot_model

        return plot_model(self, axes)

    @property
    def nodal_mass(self) -> SparseMatrix:
        """Mass matrix (6 n_node, 6 n_node) before couplings and supports, for moving supports.

        Assembled at every call, because a large model would rarely need it again.
        """
        return assemble_matrices(self.assembly).M

    @property
    def M(self) -> SparseMatrix:
        """Mass matrix (n_dof, n_dof)."""
        return self.structure.M

    @property
    def C(self) -> SparseMatrix:
        """Damping matrix (n_dof, n_dof)."""
        return self.structure.C

    @property
    def K(self) -> SparseMatrix:
        """Stiffness matrix (n_dof, n_dof), bolts and sticking areas included."""
        return self.structure.K

    @property
    def rigid_motions(self) -> Matrix:
        """R (n_dof, n_motion), free rigid motions; RᵀMR = I."""
        return self.structure.rigid_motions

    @property
    def damping(self) -> Rayleigh:
        """Rayleigh factors of C."""
        return self.structure.matrices.damping

    @cached_property
    def contact(self) -> Contact:
        """All interfaces stacked."""
        stacked = stack(self.interfaces, self.structure.n_dof)
        return replace(stacked, dense_budget=self.structure.dense_budget)

    @cached_property
    def port_compliance(self) -> PortCompliance:
        """Static compliance between contact pairs, boundary, bolts and load patterns."""
        if not self.load_patterns:
            return self.structure.port_compliance
        return self.structure.loaded_ports(self.pattern_forces)

    @property
    def pattern_forces(self) -> Matrix:
        """Forces of all load patterns (n_pattern, n_dof)."""
        return pattern_forces(self.load_patterns, self.structure.n_dof)

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem of the full model."""
        return static_contact_of(self)

    def factorize_static(self) -> Factorization:
        """Return the factorization of K from that of the structure."""
        return self.structure

    def expand(self, states: Matrix) -> Matrix:
        """Return the states themselves, which are the free displacements."""
        return states

    def with_dense_budget(self, n_bytes: int) -> "Model":
        """Return a copy with another memory budget for dense contact matrices.

        Beyond it sparse factors are used; existing factorizations and condensations are formed
        anew.
        """
        structure = replace(self.structure, dense_budget=int(n_bytes))
        return replace(self, structure=structure)

    def with_penalty(self, penalty: float) -> "Model":
        """Return a copy with another contact stiffness on all interfaces (``inf`` is hard)."""
        return self.with_interfaces(
            {name: interface.with_penalty(penalty) for name, interface in self.interfaces.items()}
        )

    def with_closure(self, closure: Curve | Mapping[str, Curve]) -> "Model":
        """Return a copy with curves of pressure over closure in place of a contact stiffness.

        Parameters
        ----------
        closure
            Curve of all interfaces, as :class:`faying.ExponentialClosure`; or interface name to
            curve, with no change for interfaces that are not named.

        Raises
        ------
        ModelError
            If there is no such interface.

        Notes
        -----
        Friction is unchanged, including its tangential penalty.
        """
        closures = (
            closure if isinstance(closure, Mapping) else dict.fromkeys(self.interfaces, closure)
        )
        return self.with_interfaces(
            {name: self._interface(name).with_closure(curve) for name, curve in closures.items()}
        )

    def with_friction(
        self,
        friction: float | Mapping[str, float],
        tangential_penalty: TangentialPenalty | Mapping[str, TangentialPenalty] = "auto",
    ) -> "Model":
        """Return a copy with Coulomb friction.

        Parameters
        ----------
        friction
            Coefficient μ of all interfaces, 0 removes friction; or interface name to
            coefficient, with no change for interfaces that are not named.
        tangential_penalty : [force/length³]
            c_t; ``"auto"`` is c_n 2 (1 − ν)/(2 − ν) with the smallest ν of the model's materials,
            and infinite where normal contact is hard (c_n of a curve is its ``stiffness``). Or
            interface name to c_t, ``"auto"`` where it is not named.

        Raises
        ------
        ModelError
            If a number is out of range, there is no such interface, one has a tangential penalty
            and no coefficient, or ``"auto"`` finds no material.

        Notes
        -----
        Tangential displacements are further ports, for which the structure is factorized anew at
        their first use; copies that change coefficients of friction share this factorization.
        With μ = 0 the model is frictionless and costs no more.
        """
        coefficients = (
            friction if isinstance(friction, Mapping) else dict.fromkeys(self.interfaces, friction)
        )
        stiffness = (
            tangential_penalty
            if isinstance(tangential_penalty, Mapping)
            else dict.fromkeys(coefficients, tangential_penalty)
        )
        for name in stiffness:
            self._interface(name)
            if name not in coefficients:
                refuse_model(
                    f"interface '{name}' has a tangential penalty and no coefficient of friction; "
                    "give both or none"
                )
        changed = {}
        for name, coefficient in coefficients.items():
            interface = self._interface(name)
            law = self._rubbing(interface, coefficient, stiffness.get(name, "auto"))
            changed[name] = interface.with_law(law)
        return self.with_interfaces(changed)

    def _rubbing(
        self, interface: Interface, friction: float, tangential_penalty: TangentialPenalty
    ) -> Law:
        normal = interface.law.normal
        with naming(f"interface '{interface.name}'"):
            return with_friction(normal, friction, tangential_penalty, self.assembly)

    def with_initial_gap(self, name: str, initial_gap: Vector) -> "Model":
        """Return a copy with other initial gaps (n_point,) on one interface."""
        return self.with_interfaces({name: self._interface(name).with_initial_gap(initial_gap)})

    def with_interfaces(self, interfaces: Mapping[str, Interface]) -> "Model":
        """Return a copy with interfaces of the same geometry but another law or gap.

        Notes
        -----
        A law with friction where there was none needs more ports; see :meth:`with_friction`.
        """
        for name in interfaces:
            self._interface(name)
        changed, structure = {**self.interfaces, **interfaces}, self.structure
        components = [
            [interface.law.components for interface in interfaces_of.values()]
            for interfaces_of in (self.interfaces, changed)
        ]
        if components[0] == components[1]:
            return replace(self, interfaces=changed)
        stacked = stack(changed, structure.n_dof)
        if not _are_equal(stacked.relative_operator, structure.relative_operator):
            structure = replace(structure, relative_operator=stacked.relative_operator)
        return replace(self, interfaces=changed, structure=structure)

    def with_bolt_forces(self, initial_forces: Mapping[str, float]) -> "Model":
        """Return a copy with bolts locked at other initial forces N₀."""
        for name in initial_forces:
            check_known(name, self.bolts, "bolt")
        locked = {name: self.bolts[name].locked(force) for name, force in initial_forces.items()}
        copy = replace(self, bolts={**self.bolts, **locked})
        # Contact is independent of the initial forces of bolts, so its preparation is shared.
        shared = ("contact", "port_compliance", "static_contact")
        vars(copy).update({name: vars(self)[name] for name in shared if name in vars(self)})
        return copy

    def with_deck_loads(self, *names: str) -> "Model":
        """Return a copy with load patterns from its deck, by their names in ``assembly.loads``.

        Raises
        ------
        ModelError
            If the deck has no such load, or as :meth:`with_load_patterns`.
        """
        deck = self.assembly.loads
        for name in names:
            check_known(name, deck, "deck load")
        return self.with_load_patterns({name: deck[name] for name in names})

    def with_load_patterns(self, loads: Mapping[str, NodalLoads]) -> "Model":
        """Return a copy with distributed loads, each scaled by one amplitude; see :class:`Load`.

        Raises
        ------
        ModelError
            If a load acts on nothing, moves nothing, or has the name of another load.

        Notes
        -----
        One back-substitution for each load when it is first used, and again in copies.
        """
        for name in loads:
            check_pattern_name(name, self.boundaries)
        patterns = {
            name: load_pattern(name, load, self.assembly, self.dofs) for name, load in loads.items()
        }
        return replace(self, load_patterns={**self.load_patterns, **patterns})

    def with_stiffness(
        self, added: SparseMatrix, stuck: Mapping[str, Mask], stiffness: float = 0.0
    ) -> "Model":
        """Return a copy with springs (n_dof, n_dof) added to K for the pairs that stick.

        Parameters
        ----------
        stiffness : [force/length]
            Stiffness of each pair, needed for the forces of these springs.
        """
        structure = replace(self.structure, matrices=self.structure.matrices.stiffened(added))
        return replace(
            self,
            structure=structure,
            stuck={**self.stuck, **stuck},
            stuck_stiffness=stiffness or self.stuck_stiffness,
        )

    def _interface(self, name: str) -> Interface:
        check_known(name, self.interfaces, "interface")
        return self.interfaces[name]


def _are_equal(first: SparseMatrix, second: SparseMatrix) -> bool:
    """Return whether two sparse matrices are equal."""
    return first.shape == second.shape and not (first != second).nnz
