"""Attachment modes: the interface with its inertia, (M8) to (M10) of docs/theory/method.md."""

import json
from dataclasses import replace
from functools import partial

import numpy as np
import pytest

import faying as fy
from fake_results import fake_results
from faying.assessment.transient_error import HINT
from faying.exceptions import ModelError
from faying.joint.free_matrices import FreeMatrices
from faying.linalg.memory import VARIABLE, NotEnoughMemoryError
from faying.reduction.basis import ModeKind
from faying.simulation.stepping import transient_solver
from faying.study.judgement.remarks import remarks
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.workflow.run import run
from small_study import NO_REPORT, TINY_JOINT, reduction, step
from windows_of_one import windows_of_one

LC2 = {"tip.Fz": -500.0, "tip.Mx": 20e3}
SCHEMES = {
    "implicit Euler": fy.ImplicitEuler(),
    "generalized-alpha": fy.GeneralizedAlpha(0.8),
    "energy-decaying": fy.EnergyDecaying(),
}


@pytest.fixture(scope="module")
def basis(joint, classic):
    return fy.attachment_modes(joint, classic=classic, moments=4, refined=40)


@pytest.fixture(scope="module")
def rom(joint, basis):
    return fy.reduce(joint, basis)


def held(basis):
    """Return the shapes that vanish on the boundary."""
    return basis.vectors[:, [kind is not ModeKind.CONSTRAINT for kind in basis.kinds]]


def test_form_of_the_basis(joint, classic, basis):
    """The classic basis unchanged, then shapes that vanish on the boundary, orthonormal in K."""
    count = basis.count(ModeKind.ATTACHMENT)
    np.testing.assert_array_equal(basis.vectors[:, : len(classic)], classic.vectors)
    assert basis.kinds == classic.kinds + (ModeKind.ATTACHMENT,) * count
    shapes = held(basis)
    assert not shapes[joint.structure.boundary].any()
    gram = shapes.T @ (joint.K @ shapes)
    # Projected twice: round-off, over the root of the smallest new part that is kept, 1e-5.
    np.testing.assert_allclose(gram, np.eye(len(gram)), atol=1e-10)


def test_moments_of_the_interface_are_exact(joint, basis):
    """Of (M9): compliance and inertia between pairs, which compliance alone has only the first of.

    Round-off of products with shapes scaled by up to 1e5 leaves less than 1e-9.
    """
    structure, inner = joint.structure, held(basis)
    P, M = structure.relative_operator, structure.M
    attached = structure.solve_held(P.T.toarray())
    seen, mass = P @ inner, inner.T @ (M @ inner)
    for found, true in (
        (seen @ seen.T, P @ attached),
        (seen @ mass @ seen.T, attached.T @ (M @ attached)),
    ):
        np.testing.assert_allclose(found, true, rtol=0, atol=1e-9 * np.abs(true).max())


def test_moments_of_the_boundary_are_exact(joint):
    """Of (M10): as many times as asked for, and once more through the shapes of the interface."""
    bare = fy.craig_bampton(joint, normal_modes=0)
    basis = fy.attachment_modes(joint, classic=bare, moments=4, refined=0)
    structure, inner = joint.structure, held(basis)
    P, M = structure.relative_operator, structure.M
    seen, mass = P @ inner, inner.T @ (M @ inner)
    forces = M @ structure.constraint_modes
    found, true = inner.T @ forces, structure.solve_held(forces)
    for _ in range(4 + 1):
        size = np.abs(P @ true).max(axis=0)
        # 4e-7 where motions of both sides nearly cancel; one moment less leaves 3e-5.
        np.testing.assert_allclose(seen @ found / size, P @ true / size, rtol=0, atol=1e-6)
        found, true = mass @ found, structure.solve_held(M @ true)


@pytest.mark.parametrize(
    "parameters",
    [
        {"element_size": 5.0, "penalty": "hard"},
        {"curvature": 2e-3, "element_size": 5.0},
        {"shape": "tet10", "element_size": 10.0},
        {"plates": 3, "element_size": 5.0, "bolt_positions": ((-10.0, 0.0), (10.0, 0.0))},
    ],
    ids=["hard", "curved", "tet10", "two interfaces, two bolts"],
)
def test_static_solutions_are_those_of_the_full_model(parameters):
    model = fy.lap_joint(**parameters)
    model = fy.preload(model, dict.fromkeys(model.bolts, 10e3), sticking=fy.Sticking())
    basis = fy.attachment_modes(model, normal_modes=5, moments=0, refined=0)
    load = fy.Load({**LC2, "tip.Fx": 1e3})
    found, full = (fy.solve_static(one, load) for one in (fy.reduce(model, basis), model))
    # The bound of compliance, for the same reason (test_compliance).
    assert fy.compare(found, full).max_relative_error < 1e-8
    # Its shapes are all that moves, so displacements of all nodes are at hand.
    np.testing.assert_allclose(
        found.full_displacement(), full.states, rtol=0, atol=1e-8 * np.abs(full.states).max()
    )


@pytest.mark.long
@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_joint_that_nothing_was_tried_on_follows_a_jump(scheme):
    """Three plates under two bolts: 1 % where compliance alone is up to 20 % off."""
    model = fy.lap_joint(
        plates=3,
        length=90.0,
        thickness=8.0,
        overlap=45.0,
        element_size=5.0,
        bolt_positions=((-12.0, 0.0), (12.0, 0.0)),
        damping=fy.Rayleigh(alpha=160.0, beta=5e-7),
    )
    model = fy.preload(model, dict.fromkeys(model.bolts, 7e3), sticking=fy.Sticking())
    step = 0.01 / fy.preloaded_frequencies(model, 1)[0]
    load = fy.Load({"tip.Fz": -300.0, "tip.Mx": 8e3})
    options = {"step": step, "duration": 25 * step, "integrator": SCHEMES[scheme]}
    full = fy.solve_transient(model, load, **options)
    classic = fy.craig_bampton(model, normal_modes=20)
    without = fy.reduce(model, classic, compliance=True)
    carried = fy.reduce(model, fy.attachment_modes(model, classic=classic))
    poor, good = (
        fy.compare(fy.solve_transient(one, load, **options), full) for one in (without, carried)
    )
    # The target of the method is 3 % and 0.2 %; measured on other lap joints 0.2 and 0.01 %.
    assert good.max_relative_error < 0.01
    assert good.rms_relative_error < 0.002
    assert poor.max_relative_error > 5 * good.max_relative_error


@pytest.mark.long
def test_friction_moves_as_in_the_full_model(joint, classic):
    model = joint.with_friction(0.2)
    rom = fy.reduce(model, fy.attachment_modes(model, classic=classic))
    options = {"step": 2e-5, "duration": 2e-4}
    load = fy.Load({"tip.Fx": 1500.0, **LC2})
    found, full = (fy.solve_transient(one, load, **options) for one in (rom, model))
    # As without friction.
    assert fy.compare(found, full).max_relative_error < 0.01


def test_its_error_is_estimated(joint, classic):
    rom = fy.reduce(joint, fy.attachment_modes(joint, classic=classic))
    options = {"step": 1.6e-5, "duration": 4e-4, "integrator": fy.EnergyDecaying()}
    load = fy.Load(LC2)
    motion, full = (fy.solve_transient(one, load, **options) for one in (rom, joint))
    true = fy.compare(motion, full).max_relative_error
    found = fy.transient_error(joint, motion, load, integrator=options["integrator"])
    # Measured on three joints: 0.5 to 1.2; a factor of 3 is what an estimate is to keep.
    assert 1 / 3 < found.max_relative_error / true < 3


def test_a_saved_model_moves_to_the_same_bits(rom, tmp_path):
    rom.save(tmp_path / "joint.faying")
    back = fy.read_reduced_model(tmp_path / "joint.faying")
    assert (back.method, back.basis.kinds) == ("compliance+inertia", rom.basis.kinds)
    options = {"step": 2e-5, "duration": 4e-4, "integrator": fy.EnergyDecaying()}
    one, other = (fy.solve_transient(model, fy.Load(LC2), **options) for model in (rom, back))
    np.testing.assert_array_equal(one.pressure, other.pressure)


def test_a_restart_moves_to_the_same_bits(rom):
    solver = transient_solver(rom, step=2e-5, integrator=fy.GeneralizedAlpha(0.8))
    windows = partial(windows_of_one, solver, fy.Load(LC2), duration=4e-4, length=7)
    (first, middle), *others = windows()
    for (piece, _), (other, _) in zip(windows(restart=middle), others, strict=True):
        np.testing.assert_array_equal(piece.pressure, other.pressure)
    whole = solver.solve(fy.Load(LC2), duration=4e-4)
    both = np.concatenate([first.pressure, *(piece.pressure for piece, _ in others)])
    # The compiled loop begins each window anew, which moves the last digits of its systems.
    np.testing.assert_allclose(both, whole.pressure, atol=1e-9 * whole.pressure.max())


def test_a_structure_without_mass_is_refused(joint):
    massless = FreeMatrices(form=lambda: (0.0 * joint.M, joint.K, None))
    structure = replace(joint.structure, matrices=massless)
    with pytest.raises(ModelError, match="no mass"):
        fy.attachment_modes(replace(joint, structure=structure))


def test_shapes_that_do_not_fit_are_refused(joint, classic, monkeypatch):
    monkeypatch.setenv(VARIABLE, "1e6")
    with pytest.raises(NotEnoughMemoryError, match=r"shapes of interface and inertia take .* GB"):
        fy.attachment_modes(joint, classic=classic)


STUDY = (
    TINY_JOINT
    + reduction("compliance", "compliance+inertia")
    + NO_REPORT
    + step("jump", "Fz", -100.0, "step = 2e-5\nduration = 4e-4\n")
)


STATIC = "the flexibility of the interface is missing"


@pytest.mark.parametrize(
    ("errors", "hint"),
    [
        ({"compliance": 0.2}, HINT),
        ({"compliance": 0.02}, None),
        ({"compliance": 0.2, "compliance+inertia": 0.01}, None),
        ({"craig-bampton": 3.0, "jim-a": 0.5, "compliance": 0.002}, None),
        ({"craig-bampton": 3.0, "jim-b+compliance": 0.05}, HINT),
        ({"craig-bampton": 3.0, "jim-a": 0.02}, f"craig-bampton: {STATIC}"),
        ({"craig-bampton": 3.0, "compliance+inertia": 0.01}, None),
        ({"craig-bampton": 0.01}, None),
    ],
)
def test_runs_name_what_is_missing_where_it_is_missing(errors, hint):
    said = remarks(estimated(errors))
    hints = [line for line in said if HINT in line or STATIC in line]
    assert len(hints) == (hint is not None)
    assert hint is None or hints[0].startswith(hint)


def estimated(errors, traction=None):
    """Return results of a transient by methods of which errors are estimated."""
    results = fake_results()
    case = results.cases["LC2-step"]
    result = case.methods["compliance"][0]
    methods = {}
    for method, error in errors.items():
        estimate = replace(result.accuracy, max_relative_error=error, max_traction_error=traction)
        response = replace(result.response, estimate=estimate)
        methods[method] = {0: replace(result, response=response)}
    return replace(results, cases={"push": replace(case, methods=methods)})


@pytest.mark.parametrize("traction", [None, 0.0888])
def test_runs_say_what_is_estimated_of_tractions(traction):
    said = remarks(estimated({"compliance": 0.02}, traction))
    (line,) = (line for line in said if line.startswith("push, errors estimated"))
    (observed,) = (line for line in said if line.startswith("(Estimates"))
    assert line.endswith("compliance 2.00% (tractions 8.88%)" if traction else "2.00%")
    assert "of tractions" in observed


@pytest.mark.long
def test_studies_name_it(tmp_path):
    """Reduced, compared, kept with the results and handed over like the others."""
    (tmp_path / "study.toml").write_text(STUDY, encoding="utf-8")
    out = tmp_path / "out"
    assert run(read_study(tmp_path / "study.toml"), out)["converged"]
    found = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    errors = {
        name: sizes["0"]["max_relative_error"]
        for name, sizes in found["load_cases"]["jump"]["methods"].items()
    }
    # On a mesh of 10 mm the shapes are nearly all that moves: 1e-4 and less.
    assert errors["compliance+inertia"] < 1e-3 < errors["compliance"]
    rom = read_results(out / "results.h5").reduced["compliance+inertia"][0]
    assert rom.basis.count(ModeKind.ATTACHMENT) > 0
    assert rom.contact.residual_compliance is None
