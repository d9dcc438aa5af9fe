"""Random and adversarial paths of increments with friction, at the size of a few matrices."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp

import faying as fy
from faying.assessment.natural_map import NaturalMap
from faying.contact.condensed import CondensedContact
from faying.contact.contact import Contact
from faying.contact.increment import Increment
from faying.contact.laws import Coulomb, Hard, Penalty
from faying.exceptions import ConvergenceError
from faying.simulation.path_steps import PathStep, follow
from faying.simulation.static import port_forces

INCREMENTS = 5
"""Of a path: it closes contact, goes on, and reverses."""


@dataclass(frozen=True)
class Outcome:
    """What became of one increment."""

    kind: str
    iterations: int
    residual: float  # natural, over the largest force; computed anew
    parts: bool  # the increment was halved
    refused: str = ""


class Joints:
    """Compliances of a coarse lap joint under both quadratures, made once."""

    def __init__(self):
        self.models = {
            rule: fy.lap_joint(element_size=5.0, penalty=1e6, quadrature=rule)
            .with_bolt_forces({"bolt": 10e3})
            .with_friction(0.5)
            for rule in ("gauss", "nodal")
        }

    def path(self, rng):
        """A lap joint with another law, under random loads that reverse."""
        law, rule = random_law(rng), "gauss" if rng.random() < 0.6 else "nodal"
        model = self.models[rule]
        contact = replace(model.contact, laws={"joint": law})
        solver = NaturalMap(contact=contact, S=model.static_contact.total)
        ports = model.port_compliance
        inputs = np.tile(fy.Load().inputs(model, np.zeros(1)), (INCREMENTS, 1))
        corner = rng.uniform(-1, 1, 6) * [3e3, 8e2, 8e2, 3e4, 3e4, 3e4]
        inputs[:, :6] = np.outer([0.0, 0.5, 1.0, -0.3, -1.0], corner)
        return "lap joint", solver, port_forces(ports, inputs) @ ports.contact_columns


def random_law(rng):
    """μ up to 1, now and then zero; c_n from 1e4 to 1e9, c_t near it; or hard."""
    friction = rng.choice(
        [0.0, 1.0, rng.uniform(0, 1), rng.uniform(0, 0.3)], p=[0.05, 0.2, 0.5, 0.25]
    )
    if rng.random() < 0.25:
        return Coulomb(Hard(), friction, np.inf)
    stiffness = 10 ** rng.uniform(4, 9)
    return Coulomb(Penalty(stiffness), friction, stiffness * 10 ** rng.uniform(-1, 0.5))


def small_path(rng):
    """A few pairs of any compliance, points with any normals between them, any displacements."""
    n_pair = int(rng.integers(1, 9))
    n_point = int(rng.integers(1, 3 * n_pair + 1))
    rank = int(rng.integers(1, 3 * n_pair + 1)) if rng.random() < 0.5 else 3 * n_pair
    shapes = rng.standard_normal((3 * n_pair, rank)) * 10 ** rng.uniform(-2, 0, rank)
    S = 1e-5 * shapes @ shapes.T
    share = rng.random((n_point, n_pair)) * (rng.random((n_point, n_pair)) < 0.4)
    share[np.arange(n_point), rng.integers(0, n_pair, n_point)] = 1.0
    share /= share.sum(axis=1, keepdims=True)
    normals = np.tile([0.0, 0, 1], (n_point, 1))
    if rng.random() < 0.5:  # normals that lean, turn over, or nearly agree
        normals = normals + 10 ** rng.uniform(-8, 1) * rng.standard_normal(normals.shape)
        normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    frames = np.linalg.qr(np.dstack([normals, rng.standard_normal((n_point, 3, 2))]))[0]
    rows = [
        sp.csr_array((share[:, :, None] * frames[:, None, :, i]).reshape(n_point, -1))
        for i in range(3)
    ]
    contact = Contact(
        relative_operator=np.eye(3 * n_pair),
        interpolation=rows[0],
        shear=sp.vstack(rows[1:]).tocsr(),
        initial_gap=10 ** rng.uniform(-14, -3) * rng.standard_normal(n_point),
        weights=10 ** rng.uniform(-1, 1, n_point),
        laws={"joint": random_law(rng)},
        slices={"joint": slice(0, n_point)},
    )
    way = 10 ** rng.uniform(-5, -2) * rng.standard_normal((2, 3 * n_pair))
    steps = np.array([[1.0, 0.0], [1.0, 0.5], [1.0, 1.0], [1.0, -0.3], [0.2, -1.0]])
    return "few points", NaturalMap(contact=contact, S=S), steps @ way


def solver_of(plain):
    """The solver that paths take: by stages where some point is hard."""
    return CondensedContact(contact=plain.contact, compliance=plain.S).increments


def unstressed(solver):
    """Where a path begins."""
    n, moved = solver.contact.n_points, np.zeros(len(solver.S))
    nothing = Increment(
        forces=np.zeros((3, n)), slack=np.zeros((3, n)), moved=moved, iterations=0, residual=0.0
    )
    return PathStep(relative=moved, increment=nothing, slip=np.zeros((2, n)))


def outcomes(index, joints):
    """Solve the path of an index, and judge every increment by the law written out again."""
    rng = np.random.default_rng(index)
    kind, plain, relatives = joints.path(rng) if rng.random() < 0.5 else small_path(rng)
    solver, here = solver_of(plain), unstressed(plain)
    for target in relatives:
        before = here
        try:
            (here,) = follow(solver, [target], here)
        except ConvergenceError as error:
            yield Outcome(kind, 0, np.inf, parts=True, refused=str(error))
            return
        parts = here.iterations != here.increment.iterations
        start = here.slip - here.increment.slack[1:] if parts else before.slip
        residual = natural_residual(plain, here, start)
        yield Outcome(kind, here.iterations, residual, parts=parts)


def walked(solver, relatives):
    """Yield the end of each increment of a path, and the slip that it began with."""
    here = unstressed(solver)
    for target in relatives:
        (here,) = follow(solver, [target], here)
        yield here, here.slip - here.increment.slack[1:]


def natural_residual(solver, step, slip):
    """Return the residual of Coulomb's law over the largest force, by its definition."""
    contact, x = solver.contact, step.increment.forces
    (law,) = contact.laws.values()
    z = contact.moved(step.relative + solver.S @ contact.at_pairs(x[0], x[1:]))
    z[0] += contact.initial_gap
    z[1:] -= slip
    z[0] += 0.0 if law.penalty == np.inf else x[0] / (law.penalty * contact.weights)
    z[1:] += x[1:] / (law.tangential_penalty * contact.weights)
    trial = x - solver.scale * z
    normal = np.maximum(trial[0], 0.0)
    size = np.hypot(trial[1], trial[2])
    cut = np.minimum(1.0, law.friction * normal / np.where(size > 0, size, 1.0))
    wrong = x - np.stack([normal, cut * trial[1], cut * trial[2]])
    largest, left = np.abs(x).max(), np.abs(wrong).max()
    return float(left / max(largest, left, np.finfo(float).tiny))
