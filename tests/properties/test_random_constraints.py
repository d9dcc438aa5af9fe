"""Whatever the constraints, T satisfies all of them and is the identity on the free rows."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.model.assembly import Assembly, AverageCoupling, Equation, RigidCoupling, Support
from faying.model.constraints import constrain
from faying.model.mesh import Mesh

N_NODE = 24


def random_assembly(seed):
    """Couplings in a chain: each takes nodes no other made dependent, from a random order."""
    rng = np.random.default_rng(seed)
    order = rng.permutation(N_NODE)
    points = rng.uniform(-2, 2, (N_NODE, 3))
    axes = np.linalg.qr(rng.standard_normal((3, 3)))[0]
    # Dependent nodes 0-4, 5, 6, 7; nodes 8 and 9 are references, 0-3 are averaged as well.
    rigid = (
        RigidCoupling(id=1, reference=order[8], nodes=order[:4]),
        RigidCoupling(id=2, reference=order[5], nodes=order[4:5], components=(0, 1, 3)),
    )
    average = AverageCoupling(
        id=3,
        reference=order[5],
        nodes=order[[0, 1, 10, 11, 12]],
        weights=rng.uniform(0.5, 2, 5),
        components=(0, 1, 2) if rng.random() < 0.5 else (0, 1, 2, 3, 4, 5),
    )
    coefficients = rng.uniform(0.5, 2, 3) * rng.choice([-1, 1], 3)
    terms = [
        (int(order[6]), 1, coefficients[0]),
        (int(order[4]), 0, coefficients[1]),
        (int(order[13]), 2, coefficients[2]),
    ]
    supports = (
        Support(id=5, nodes=order[14:16], components=(0, 1, 2)),
        Support(id=6, nodes=order[15:18], components=(0, 4), axes=axes),
    )
    assembly = Assembly(
        mesh=Mesh(nodes=points, node_ids=1 + np.arange(N_NODE)),
        rigid_couplings=rigid,
        average_couplings=(average,),
        equations=(Equation(id=4, terms=tuple(terms)),),
        supports=supports,
    )
    loaded = 6 * order[5] + rng.permutation(6)[: rng.integers(0, 7)]
    return assembly, loaded


def residuals(assembly, u):
    """Violation of every constraint by displacements u (n_node, 6), from the definitions."""
    x = assembly.mesh.nodes
    found = []
    for c in assembly.rigid_couplings:
        body = u[c.reference, :3] + np.cross(u[c.reference, 3:], x[c.nodes] - x[c.reference])
        body = np.hstack([body, np.tile(u[c.reference, 3:], (len(c.nodes), 1))])
        found.append((u[c.nodes] - body)[:, list(c.components)])
    for c in assembly.average_couplings:
        # The least-squares residual is orthogonal to the six rigid motions about the reference.
        arms = x[c.nodes] - x[c.reference]
        body = u[c.reference, :3] + np.cross(u[c.reference, 3:], arms)
        body = np.hstack([body, np.tile(u[c.reference, 3:], (len(arms), 1))])
        weight = np.repeat([1.0, np.linalg.norm(arms, axis=1).mean() ** 2], 3)
        weight[[i not in c.components for i in range(6)]] = 0
        pull = c.weights[:, None] * weight * (u[c.nodes] - body)
        found.append(pull[:, :3].sum(axis=0))
        found.append((pull[:, 3:] + np.cross(arms, pull[:, :3])).sum(axis=0))
    found.append(np.array([sum(a * u[n, c] for n, c, a in e.terms) for e in assembly.equations]))
    for s in assembly.supports:
        axes = np.eye(3) if s.axes is None else s.axes
        local = np.hstack([u[s.nodes, :3] @ axes.T, u[s.nodes, 3:] @ axes.T])
        found.append(local[:, list(s.components)])
    return np.concatenate([part.ravel() for part in found])


@pytest.mark.long
@settings(max_examples=60)
@given(st.integers(0, 2**32 - 1))
def test_every_free_motion_satisfies_every_constraint(seed):
    assembly, keep = random_assembly(seed)
    dofs = constrain(assembly, np.ones(6 * N_NODE, dtype=bool), keep=keep)
    T = dofs.transformation.toarray()
    violation = np.array([residuals(assembly, c.reshape(-1, 6)) for c in T.T])
    # Kept dofs are exchanged by pivoted QR, whose solution grows where nodes are nearly collinear.
    assert np.abs(violation).max() < 1e-9 * max(1.0, np.abs(T).max())
    np.testing.assert_array_equal(T[dofs.free], np.eye(len(dofs.free)))
    assert set(keep.tolist()) <= set(dofs.free.tolist())


@pytest.mark.long
@settings(max_examples=30)
@given(st.integers(0, 2**32 - 1))
def test_number_of_free_dofs_is_all_minus_independent_equations(seed):
    assembly, keep = random_assembly(seed)
    dofs = constrain(assembly, np.ones(6 * N_NODE, dtype=bool), keep=keep)
    unit = np.eye(6 * N_NODE)
    equations = np.array([residuals(assembly, u.reshape(-1, 6)) for u in unit]).T
    # Random points are in general position, so the rank is clear.
    assert len(dofs.free) == 6 * N_NODE - np.linalg.matrix_rank(equations, tol=1e-8)
