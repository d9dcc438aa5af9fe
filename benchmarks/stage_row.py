"""One row of ``benchmarks/stages.py``: every stage of one lap joint, in this process.

    python benchmarks/stage_row.py '{"element_size": 2.5, "overlap": 40, "order": 2}'

Prints one JSON object: sizes, seconds of each stage, peak memory of the process after it.
"""

import json
import os
import resource
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spla

import faying as fy
from faying.joint.lap_joint import lap_joint_assembly
from faying.joint.system import input_forces
from faying.linalg.factorization import factorize
from faying.model.matrices import assemble_matrices
from faying.simulation.integrators import ImplicitEuler, Motion
from faying.simulation.newton import solve_static_newton
from faying.simulation.static import relative_forces
from faying.simulation.stepping import transient_solver

PRELOAD = {"bolt": 10e3}
LC2 = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
BOX = fy.LoadBox(ranges={"tip.Fz": (-750.0, 750.0), "tip.Mx": (-30e3, 30e3)})
DAMPING = fy.Rayleigh(alpha=160.0, beta=5e-7)

TRAINING_RUNS, STEPS_PER_PERIOD = 8, 100
"""Step responses that train method B, each of one period."""

FULL_STEPS, TRAINING_STEPS, WARM_CASES, NEWTON_CASES, NEWTON_STEPS = 10, 20, 50, 2, 3
"""How many of each are measured."""

REDUCED_STEPS, LONG_STEPS, STEP_RUNS = 200, 5000, 5
"""Steps of a reduced run from the jump on, of a long one, and runs of each."""

NAIVE_COLUMNS = 50
"""Back-solves of the naive way that are measured and scaled to all contact points."""


class Row:
    """What a row measured."""

    def __init__(self, *, quick: bool) -> None:
        self.quick = quick
        self.seconds: dict[str, float] = {}
        self.wall: dict[str, float] = {}
        self.peak_gib: dict[str, float] = {}
        self.facts: dict[str, Any] = {"load_average": [round(v, 2) for v in os.getloadavg()]}

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Measure processor and wall time of a stage, and the process's peak memory after it."""
        start, began = time.process_time(), time.perf_counter()
        yield
        self.seconds[name] = time.process_time() - start
        self.wall[name] = time.perf_counter() - began
        self.peak_gib[name] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
        seconds, wall = self.seconds[name], self.wall[name]
        sys.stderr.write(f"    {name}: {seconds:.2f} s, wall {wall:.2f} s\n")


def main() -> None:
    """Measure the row given and print it."""
    if sys.argv[1] == "bandwidth":
        sys.stdout.write(json.dumps(bandwidth()) + "\n")
        return
    options = json.loads(sys.argv[1])
    extras = options.pop("extras", [])
    row = Row(quick=options.pop("quick", False))
    model = offline(row, options)
    rom = fy.reduce(model, row.classic, compliance=True)
    online(row, rom)
    for extra in extras:
        EXTRAS[extra](row, model, options)
    row.facts["load_average_end"] = [round(v, 2) for v in os.getloadavg()]
    row.facts["threads"] = os.environ.get("OMP_NUM_THREADS", "all")
    sys.stdout.write(
        json.dumps({**row.facts, "s": row.seconds, "wall": row.wall, "peak_gib": row.peak_gib})
        + "\n"
    )


def bandwidth() -> dict[str, float]:
    """Bytes per second of a copy and a dot product beyond all caches, the best of nine."""
    first, second = np.ones(2**25), np.zeros(2**25)
    copies, dots = [], []
    for _ in range(9):
        start = time.perf_counter()
        np.copyto(second, first)
        middle = time.perf_counter()
        np.dot(first, second)
        copies.append(middle - start)
        dots.append(time.perf_counter() - middle)
    moved = 2 * first.nbytes
    return {"copy": moved / float(np.min(copies)), "dot": moved / float(np.min(dots))}


def offline(row: Row, options: dict[str, Any]) -> fy.Model:
    """Measure the offline stages, each with what the earlier ones left."""
    stage = row.stage
    with stage("assembly"):
        model = fy.lap_joint(**options, damping=DAMPING)
        _ = model.K
    structure = model.structure
    row.facts |= {
        "dofs": structure.n_dof,
        "points": model.contact.n_points,
        "pairs": structure.relative_operator.shape[0],
    }
    with stage("factorization"):
        factor = structure.interior_factor
    row.facts |= {"backend": factor.backend, "factor_gib": factor.memory / 2**30}
    with stage("constraint modes"):
        _ = structure.boundary_factor
    with stage("compliance"):
        _ = structure.held_compliance
    with stage("preload"):
        model = fy.preload(model, PRELOAD)
    with stage("normal modes (20)"):
        row.classic = fy.craig_bampton(model, normal_modes=20)
    with stage("jim-a (40)"):
        fy.jim_a(model, joint_modes=40, classic=row.classic)
    method_b(row, model)
    with stage("reduce"):
        rom = fy.reduce(model, row.classic, compliance=True)
        _ = rom.static_contact.space
    return model


def method_b(row: Row, model: fy.Model) -> None:
    """Train method B: all static snapshots, and some steps scaled to eight periods."""
    row.period = 1.0 / float(
        np.sqrt(_lowest_square(model)) / (2 * np.pi)
    )  # of the joint whose bolt alone holds it; good enough for a step
    loads = BOX.static_loads(model)
    with row.stage("jim-b, 75 static"):
        statics = fy.static_snapshots(model, loads)
    step = row.period / STEPS_PER_PERIOD
    with row.stage("jim-b, effective matrix"):
        row.full = transient_solver(model, step=step)
    rest = fy.solve_static(model)
    row.full.solve(LC2, duration=2 * step, initial=rest)  # warm
    start = time.process_time()
    run = row.full.solve(LC2, duration=FULL_STEPS * step, initial=rest)
    row.seconds["full step"] = (time.process_time() - start) / FULL_STEPS
    together = clocked(
        lambda: row.full.solve_cases(BOX.step_loads(), duration=TRAINING_STEPS * step)
    )
    row.seconds["jim-b, 800 steps (scaled)"] = together * STEPS_PER_PERIOD / TRAINING_STEPS
    with row.stage("jim-b, modes (40)"):
        snapshots = np.hstack([statics, run.contact_forces.T])
        fy.jim_b(model, snapshots, joint_modes=40, classic=row.classic)


def _lowest_square(model: fy.Model) -> float:
    """Square of the lowest circular frequency with contact absent, by inverse iteration."""
    factor, vector = model.factorize_static(), np.ones(model.K.shape[0])
    for _ in range(12):
        vector = factor.solve(model.M @ vector)
        vector /= np.abs(vector).max()
    return float(vector @ (model.K @ vector) / (vector @ (model.M @ vector)))


def online(row: Row, rom: fy.ReducedModel) -> None:
    """Measure static cases and steps of the reduced model."""
    rng = np.random.default_rng(0)
    fy.solve_static(rom, LC2)
    times = []
    for _ in range(WARM_CASES):
        load = fy.Load(
            {"tip.Fz": float(rng.uniform(-750, 750)), "tip.Mx": float(rng.uniform(-3e4, 3e4))}
        )
        times.append(clocked(lambda load=load: fy.solve_static(rom, load)))
    row.seconds["static case"] = float(np.median(times))
    step = row.period / STEPS_PER_PERIOD
    with row.stage("reduced effective matrix"):
        in_python = transient_solver(rom, step=step)
    vars(in_python)["_compiled"] = None
    row.seconds["reduced step, in Python"], run = stepped(in_python, REDUCED_STEPS)
    row.facts["iterations_per_step"] = float(run.iterations[1:].mean())
    row.facts["step_bytes, in Python"] = python_bytes(rom)
    with row.stage("compiling, or reading what was compiled"):
        compiled = transient_solver(rom, step=step)
        compiled.solve(LC2, duration=5 * step)
    row.seconds["reduced step"], _ = stepped(compiled, REDUCED_STEPS)
    row.seconds["reduced step, long run"], _ = stepped(compiled, LONG_STEPS)
    row.facts["step_bytes"] = compiled_bytes(rom, compiled)


def stepped(solver: Any, count: int) -> tuple[float, fy.Solution]:
    """Return processor time of a step, the median of runs of so many, and the last run."""
    rest = fy.solve_static(solver.system)
    solver.solve(LC2, duration=5 * solver.step, initial=rest)
    times, found = [], []
    for _ in range(STEP_RUNS):
        start = time.process_time()
        found[:] = [solver.solve(LC2, duration=count * solver.step, initial=rest)]
        times.append((time.process_time() - start) / count)
    return float(np.median(times)), found[0]


def clocked(function: Callable[[], Any]) -> float:
    """Return the processor time of a call."""
    start = time.process_time()
    function()
    return time.process_time() - start


def python_bytes(rom: fy.ReducedModel) -> dict[str, int]:
    """Return the bytes one step in Python must read: each array it touches, counted once."""
    n, contact = len(rom.K), rom.contact
    N = contact.interpolation
    core = factor = 8 * N.shape[1] ** 2 // 2  # a triangle of S and one of E
    return {
        "M, C, K, effective factor": 8 * (2 * n**2 + n**2 + n**2 // 2),
        "P Phi": contact.relative_operator.nbytes,
        "N": N.data.nbytes + N.indices.nbytes + N.indptr.nbytes,
        "H or S": int(core),
        "active factor or E": int(factor),
    }


def compiled_bytes(rom: fy.ReducedModel, solver: Any) -> dict[str, int]:
    """Return the bytes one compiled step must read or write, each counted once."""
    given = solver._compiled
    n_pair, n_point = len(given.model["to_pairs"]), rom.contact.n_points
    return {
        "matrices of the model": sum(array.nbytes for array in given.model.values()),
        "triangles of E and S": 8 * n_pair * (n_pair + 1),
        "N": sum(getattr(given.pairs.rows, name).nbytes for name in ("columns", "values")),
        "vectors of points": 8 * 8 * n_point,  # D, g0, own, trend, forces, slacks and two at work
    }


# Beside it


def naive(row: Row, model: fy.Model, _: dict[str, Any]) -> None:
    """SciPy's SuperLU as it comes, one back-solve per contact point, full Newton per case."""
    inner = model.structure.interior
    K = sp.csc_array(model.structure.K[inner][:, inner])
    points = model.contact.gap_operator.tocsr()[:, inner]
    symmetric = {"diag_pivot_thresh": 0.0, "options": {"SymmetricMode": True}}
    orders = [("COLAMD", {}), ("MMD_AT_PLUS_A", symmetric)]
    for order, settings in orders[:1] if row.quick else orders:
        with row.stage(f"naive: SuperLU, {order}"):
            factors = spla.splu(K, permc_spec=order, **settings)
        count = min(NAIVE_COLUMNS, points.shape[0])
        columns = [points[[k]].toarray().ravel() for k in range(count)]
        taken = clocked(lambda c=columns, f=factors: [f.solve(column) for column in c])
        row.seconds[f"naive: back-solves, {order} (scaled)"] = taken * points.shape[0] / count
        row.facts[f"naive fill, {order}"] = 12 * int(factors.nnz) / 2**30
        del factors
    newton(row, model)
    row.seconds["naive: Newton case, COLAMD (scaled)"] = (
        row.facts["newton_iterations"] + 1
    ) * row.seconds["naive: SuperLU, COLAMD"]


def newton(row: Row, model: fy.Model) -> None:
    """Full Newton on the finite element equations, with faying's own factorization."""
    if "Newton case" in row.seconds:
        return
    loads = BOX.static_loads(model)[3 :: len(BOX.static_loads(model)) // NEWTON_CASES]
    times, iterations = [], []
    for load in loads[: 1 if row.quick else NEWTON_CASES]:
        start = time.process_time()
        iterations.append(int(solve_static_newton(model, load).iterations))
        times.append(time.process_time() - start)
    row.seconds["Newton case"] = float(np.median(times))
    row.facts["newton_iterations"] = float(np.mean(iterations))


def seed(row: Row, model: fy.Model, _: dict[str, Any]) -> None:
    """Snapshots of method B by full finite element contact simulations."""
    newton(row, model)
    step = row.period / STEPS_PER_PERIOD
    times, factorizations, difference = newton_steps(model, step, 1 if row.quick else NEWTON_STEPS)
    row.seconds["Newton step"] = float(np.median(times))
    row.facts |= {"newton_step_factorizations": factorizations, "newton_difference": difference}
    row.seconds["seed: training (scaled)"] = (
        75 * row.seconds["Newton case"]
        + TRAINING_RUNS * STEPS_PER_PERIOD * row.seconds["Newton step"]
    )
    row.seconds["jim-b training"] = sum(
        row.seconds[f"jim-b, {part}"]
        for part in ("75 static", "effective matrix", "800 steps (scaled)")
    )


def newton_steps(model: fy.Model, step: float, n_step: int) -> tuple[list[float], float, float]:
    """Step the full equations, with a factorization for every set of points in contact.

    Each step starts from the points in contact before it, so where none changes it takes one
    factorization, the least a Newton method can.

    Returns
    -------
    tuple
        Seconds of each step, factorizations per step, and the largest difference of contact forces
        from the condensed solution over its largest force.
    """
    contact, scheme = model.contact, ImplicitEuler()
    G = contact.gap_operator.tocsr()
    start = fy.solve_static(model)
    effective = scheme.effective_matrix(model, step)
    springs = contact.penalty * contact.weights
    external = input_forces(model, LC2.inputs(model, np.zeros(1)))[0]
    rest = np.zeros_like(start.states)
    pushing = external + relative_forces(model, start.contact_forces)
    motion = Motion(start.states, rest, rest, pushing, rest, start.contact_forces)
    active, times, count = start.contact_forces > 0, [], 0
    for _ in range(n_step):
        began = time.process_time()
        right = scheme.right_hand_side(model, motion, step) + scheme.force_weight * external
        while True:
            closed, k = G[active], springs[active]
            tangent = (effective + scheme.force_weight * (closed.T @ (closed * k[:, None]))).tocsr()
            pushed = right - scheme.force_weight * (closed.T @ (k * contact.initial_gap[active]))
            u = factorize(tangent).solve(pushed)
            count += 1
            gap = contact.initial_gap + G @ u
            settled, active = np.array_equal(gap < 0, active), gap < 0
            if settled:
                break
        forces = springs * np.maximum(-gap, 0.0)
        motion = scheme.advance(motion, u, external + relative_forces(model, forces), step)
        times.append(time.process_time() - began)
    fast = fy.solve_transient(model, LC2, step=step, duration=n_step * step)
    apart = np.abs(forces - fast.contact_forces[-1]).max() / np.abs(forces).max()
    return times, count / n_step, float(apart)


def scikit_fem(row: Row, _: fy.Model, options: dict[str, Any]) -> None:
    """Assemble K and M of the same standard bricks with scikit-fem, by the same rules."""
    import skfem
    from skfem.helpers import dot
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    from faying.joint.lap_joint import STEEL
    from faying.model.elements import SOLIDS

    assembly = lap_joint_assembly(**options, element="standard").assembly
    nodal, ours = None, []
    for _ in range(3):
        start = time.process_time()
        nodal = assemble_matrices(assembly)
        ours.append(time.process_time() - start)
    element, cells = SOLIDS["hex8"], assembly.mesh.blocks[0].nodes
    theirs = skfem.ElementHex1()
    order = [
        int(np.argmin(np.abs(element.reference_nodes - place).max(axis=1)))
        for place in np.asarray(theirs.doflocs)
    ]
    used = np.unique(cells)
    law = linear_elasticity(*lame_parameters(STEEL.youngs_modulus, STEEL.poissons_ratio))
    weight = skfem.BilinearForm(lambda u, v, _: STEEL.density * dot(u, v))
    mesh = skfem.MeshHex1(
        assembly.mesh.nodes[used].T.copy(), np.searchsorted(used, cells)[:, order].T.copy()
    )
    bases, taken = [], []
    for _ in range(2):
        start = time.process_time()
        bases = [
            skfem.Basis(mesh, skfem.ElementVector(theirs), quadrature=(q.points.T, q.weights))
            for q in (element.stiffness_quadrature(), element.mass_quadrature())
        ]
        K, M = law.assemble(bases[0]), weight.assemble(bases[1])
        taken.append(time.process_time() - start)
    row.seconds |= {
        "assembly of K and M": float(np.median(ours)),
        "scikit-fem, K and M": float(np.median(taken)),
    }
    # Vertex dofs of scikit-fem come node by node, in the order of the mesh's points.
    place = np.empty(3 * len(used), dtype=np.int64)
    place[bases[0].nodal_dofs.T.ravel()] = (6 * used[:, None] + np.arange(3)).ravel()
    row.facts["assembly_difference"] = max(
        float(abs(own[place][:, place] - other).max() / abs(other).max())
        for own, other in ((nodal.K, K), (nodal.M, M))
    )


EXTRAS = {"naive": naive, "seed": seed, "scikit-fem": scikit_fem}

if __name__ == "__main__":
    main()
