"""A reduced model: a system like the full one, Eq. (15.16), independent of finite elements."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from types import MappingProxyType

import numpy as np

from faying._typing import Matrix
from faying.contact.between_pairs import BetweenPairs
from faying.contact.by_shapes import ByShapes
from faying.contact.condensed import CondensedContact, structure_between
from faying.display.facts import Shown, counted
from faying.exceptions import refuse_model
from faying.joint.load_pattern import pattern_forces
from faying.joint.system import (
    Joint,
    PortableJoint,
    PortCompliance,
    boundary_dofs,
    boundary_slices,
    elongations,
    static_contact_of,
)
from faying.linalg.interface import Factorization
from faying.linalg.relief import factorize_relieved
from faying.linalg.substitution import symmetrized
from faying.reduction.basis import ModeKind
from faying.reduction.model_data import ModelData
from faying.reduction.model_writer import write_model
from faying.reduction.recovery import Recovery


def at_its_ports(joint: Joint, ports: PortCompliance) -> PortableJoint:
    """Return a joint reduced to its ports, from any system with the same ports."""
    places = boundary_slices(joint.boundaries)
    without = np.zeros((joint.contact.relative_operator.shape[0], 0))
    return PortableJoint(
        contact=replace(joint.contact, relative_operator=without, residual_compliance=None),
        boundaries={
            name: port.with_dofs(np.arange(places[name].start, places[name].stop))
            for name, port in joint.boundaries.items()
        },
        bolts={name: port.at_ports() for name, port in joint.bolts.items()},
        port_compliance=ports,
        load_patterns={
            name: replace(port, forces=np.zeros(0)) for name, port in joint.load_patterns.items()
        },
    )


@dataclass(frozen=True, eq=False, kw_only=True, repr=False)
class ReducedModel(Shown, ModelData):
    """A model in generalized coordinates q of u ≈ Φ q, Eq. (15.15), without the full model.

    Solutions, certificates, recovery of pressures, exports and files (:meth:`save`,
    :func:`faying.read_reduced_model`) all take this value. Its fields are those of
    :class:`~faying.reduction.model_data.ModelData`.

    Examples
    --------
    >>> import faying as fy
    >>> joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    >>> rom = fy.reduce(joint, fy.craig_bampton(joint, normal_modes=4), compliance=True)
    >>> len(rom.K), rom.method, rom.joint_modes
    (11, 'compliance', 0)
    """

    @property
    def facts(self) -> Mapping[str, str]:
        """Name, method, size and parts."""
        return {
            "name": self.name,
            "method": self.method,
            **{k: v for k, v in self.basis.facts.items() if k == "trial vectors"},
            "residual compliance": "no" if self.contact.residual_compliance is None else "yes",
            "interfaces": counted(self.interfaces),
            "bolts": counted(self.bolts),
            "boundaries": counted(self.boundaries),
            "units": self.units,
        }

    @property
    def joint_modes(self) -> int:
        """Number of joint modes of the basis."""
        return self.basis.count(ModeKind.JOINT)

    @cached_property
    def _static_factor(self) -> Factorization:
        return factorize_relieved(self.K, self.M, self.rigid_motions)

    @cached_property
    def port_compliance(self) -> PortCompliance:
        """Static compliance between the ports within the basis."""
        contact, factor, n_mode = self.contact, self._static_factor, len(self.K)
        dofs = boundary_dofs(self.boundaries)
        loads = pattern_forces(self.load_patterns, n_mode)
        outer = np.vstack([np.eye(n_mode)[dofs], elongations(self.bolts, n_mode), loads])
        answers = factor.solve(outer.T)
        if self._solves_full_contact:  # products alone are needed
            pairs: BetweenPairs = ByShapes(
                np.asarray(contact.relative_operator), factor.solve(np.eye(n_mode))
            )
        else:
            pairs = structure_between(contact, self.K, factor)
        return PortCompliance(
            pairs=pairs,
            contact_columns=(contact.relative_operator @ answers).T,
            input_rows=symmetrized(outer @ answers),
            n_boundary=len(dofs),
            n_pattern=len(loads),
        )

    @cached_property
    def static_contact(self) -> CondensedContact:
        """The static contact problem of the reduced model.

        With residual compliance this is the problem of the full model, whose inverses it shares.
        """
        return self.joint.static_contact if self._solves_full_contact else static_contact_of(self)

    @property
    def _solves_full_contact(self) -> bool:
        """Whether static contact is that of the full model."""
        return self.ports is not None and self.contact.residual_compliance is not None

    @cached_property
    def joint(self) -> PortableJoint:
        """The full model reduced to its ports, with the law and the bolts of this model.

        Raises
        ------
        ModelError
            If the compliance of the full model is not stored.
        """
        if self.ports is None:
            refuse_model(
                f"the reduced model of '{self.name}' does not know the compliance of the full "
                "model: the structure is not held without its boundary, or has too many ports for "
                "a file; recover and certify with the full model"
            )
        return at_its_ports(self, self.ports)

    @cached_property
    def recovery(self) -> Recovery:
        """The matrices that recover pressures of the full model from a motion q.

        Raises
        ------
        ModelError
            As :attr:`joint`, or if the matrices are not stored.
        """
        inertia, damping = self.recovery_inertia, self.recovery_damping
        if inertia is None or damping is None:
            refuse_model(
                f"the reduced model of '{self.name}' has no recovery matrices; make it with "
                "faying.reduce from a structure that is held, or recover with the full model"
            )
        return Recovery(
            joint=self.joint, inertia=inertia, damping=damping, frame=self.recovery_frame
        )

    def factorize_static(self) -> Factorization:
        """Return the Cholesky factorization of K, or K⁺ of (M11) for a free structure."""
        return self._static_factor

    def expand(self, states: Matrix) -> Matrix:
        """Return u = Φ q (..., n_dof of the full model) for states (..., n_mode).

        Raises
        ------
        ModelError
            If the trial vectors were left out, or a residual compliance adds displacements to
            theirs.
        """
        vectors = self.trial_vectors
        if self.contact.residual_compliance is not None:
            refuse_model(
                "the trial vectors are not all that moves in a model with residual compliance; "
                "take displacements with the full model, faying.full_displacement(model, solution)"
            )
        return states @ vectors.T

    @property
    def trial_vectors(self) -> Matrix:
        """Φ (n_dof of the full model, n_mode).

        Raises
        ------
        ModelError
            If they were left out.
        """
        if not len(self.basis.vectors):
            refuse_model(
                f"the reduced model of '{self.name}' came without its trial vectors, which "
                "displacements of the full model need; take displacements at boundaries and gaps, "
                "or save it with shapes=True"
            )
        return self.basis.vectors

    def with_bolt_forces(self, initial_forces: Mapping[str, float]) -> "ReducedModel":
        """Return a copy with bolts locked at other initial forces N₀."""
        locked = {name: self.bolts[name].locked(force) for name, force in initial_forces.items()}
        return replace(self, bolts={**self.bolts, **locked})

    def save(
        self,
        path: Path | str,
        *,
        shapes: bool = True,
        provenance: Mapping[str, str] = MappingProxyType({}),
    ) -> None:
        """Write the model to one HDF5 file, atomically; :func:`faying.read_reduced_model` reads it.

        Parameters
        ----------
        path
            File; an existing one is replaced once the new one is complete.
        shapes
            Whether to keep the trial vectors, the greater part of the file: without them there are
            no displacements of all nodes, and no pictures.
        provenance
            Further texts by name on the origin of the model, beside versions and date.

        Raises
        ------
        FormatError
            If the file cannot be written, or the interfaces are too large.
        """
        write_model(self, Path(path), shapes=shapes, provenance=provenance)
