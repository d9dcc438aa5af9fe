"""The smallest system the solvers take: dense matrices and a few contact points, no mesh."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import SimpleNamespace

import numpy as np
import scipy.sparse as sp

from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.laws import normal_law
from faying.joint.load_pattern import LoadPattern
from faying.joint.system import boundary_dofs, elongations, port_compliance_of
from faying.linalg.factorization import factorize
from faying.model.bolt import Bolt
from faying.model.boundary import Boundary


@dataclass(frozen=True, eq=False, kw_only=True)
class SmallSystem:
    """Dense M, C, K; each contact point is a pair of its own; one boundary of single forces."""

    M: np.ndarray
    C: np.ndarray
    K: np.ndarray
    contact: Contact
    boundaries: Mapping[str, Boundary]
    bolts: Mapping[str, Bolt] = field(default_factory=dict)
    load_patterns: Mapping[str, LoadPattern] = field(default_factory=dict)
    interfaces: Mapping[str, object] = field(default_factory=dict)
    name: str = "small"
    units: str = "mm-t-s"

    def __post_init__(self):
        """Points without a place of their own lie in the origin."""
        origins = {
            name: SimpleNamespace(points=np.zeros((at.stop - at.start, 3)))
            for name, at in self.contact.slices.items()
        }
        object.__setattr__(self, "interfaces", origins | dict(self.interfaces))

    @property
    def rigid_motions(self):
        return np.zeros((len(self.K), 0))

    @cached_property
    def port_compliance(self):
        dofs = boundary_dofs(self.boundaries)
        rows = [self.contact.relative_operator, np.eye(len(self.K))[dofs]]
        ports = np.vstack([*rows, elongations(self.bolts, len(self.K))])
        return port_compliance_of(
            ports @ np.linalg.solve(self.K, ports.T),
            n_relative=len(self.contact.relative_operator),
            n_boundary=len(dofs),
        )

    @cached_property
    def static_contact(self):
        return CondensedContact(contact=self.contact, compliance=self.port_compliance.relative)

    def factorize_static(self):
        return factorize(self.K)

    def expand(self, states):
        return states


def small_system(M, C, K, G, *, gap, stiffness, bolts=None, loaded=0, residual=None):
    """System with gaps ``gap + G u``, contact springs of ``stiffness``, and a load on one dof."""
    G = np.atleast_2d(np.asarray(G, dtype=float))
    n = len(G)
    contact = Contact(
        relative_operator=G,
        interpolation=sp.eye_array(n, format="csr"),
        initial_gap=np.broadcast_to(np.asarray(gap, dtype=float), n),
        weights=np.ones(n),
        laws={"stop": normal_law(stiffness)},
        slices={"stop": slice(0, n)},
        residual_compliance=residual,
    )
    end = Boundary(name="mass", nodes=[1], components=[0], dofs=[loaded])
    return SmallSystem(
        M=np.atleast_2d(np.asarray(M, dtype=float)),
        C=np.atleast_2d(np.asarray(C, dtype=float)),
        K=np.atleast_2d(np.asarray(K, dtype=float)),
        contact=contact,
        boundaries={"mass": end},
        bolts={bolt.name: bolt for bolt in bolts or ()},
    )


def two_masses(stop, residual=None, damping=0.0):
    """Two masses that meet between them, a damper, and a bolt that pulls them together."""
    row = np.array([-1.0, 1.0])
    return small_system(
        np.diag([1.0, 2.0]),
        damping * np.outer(row, row),
        np.diag([3.0, 5.0]) + 2.0 * np.outer(row, row),
        [row],
        gap=0.05,
        stiffness=stop,
        bolts=[Bolt(name="bolt", elongation=row, stiffness=2.0, initial_force=0.5)],
        residual=residual,
    )
