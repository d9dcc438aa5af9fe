"""Curves of pressure over closure: keys of studies, what is refused, surfaces that are stored."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.joint_judge import JointJudge
from faying.contact.laws import CLOSURES, Coulomb, Hard, Penalty
from faying.exceptions import ConvergenceError, FormatError, ModelError, StudyError
from faying.interface.closure_table import read_closure_table
from faying.interface.surface import contact_surface, recorded_law
from faying.joint.lap_joint import STEEL
from faying.study.inputs.load_model import build_loaded, load_model
from faying.study.inputs.loads import check_loads
from faying.study.keys.schema import read_study
from faying.study.results.store import read_results
from faying.study.stages.recover import reduced_model
from faying.study.stages.run_assessment import FAILED
from faying.workflow.run import run
from small_study import NO_REPORT, reduction, static, tiny_joint

STUDY = (
    tiny_joint("closure = CLOSURE", preload="1e4")
    + reduction("compliance")
    + static("bending", "Fz", -100.0)
)
KEYS = {
    "table": ('{ table = "layer.csv" }', fy.TableClosure((0.0, 0.1, 0.2), (0.0, 3.0, 15.0))),
    "exponential": (
        "{ exponential = { pressure = 5, clearance = 0.01 } }",
        fy.ExponentialClosure(5.0, 0.01),
    ),
    "power": (
        "{ power = { pressure = 20.0, depth = 0.005, exponent = 2 } }",
        fy.PowerClosure(20.0, 0.005, 2.0),
    ),
    "gasket": (
        "{ gasket = { closures = [0, 0.1], pressures = [0, 3], unloading = [30, 60] } }",
        fy.GasketClosure((0.0, 0.1), (0.0, 3.0), (30.0, 60.0)),
    ),
}
CURVES = [curve for _, curve in KEYS.values()]
LAYER = "# mm, MPa\npressure, closure\n0,0\n3,0.1\n15,0.2\n"


def study(folder, closure, layer=LAYER):
    (folder / "layer.csv").write_text(layer, encoding="utf-8")
    path = folder / "study.toml"
    path.write_text(STUDY.replace("CLOSURE", closure), encoding="utf-8")
    return read_study(path)


def test_every_curve_has_a_key():
    assert list(KEYS) == list(CLOSURES)


@pytest.mark.parametrize("name", CLOSURES)
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_a_study_names_every_curve(tmp_path, name, friction):
    key, curve = KEYS[name]
    loaded = load_model(study(tmp_path, f"{key}\nfriction = {friction}"))
    law = build_loaded(loaded).interfaces["joint"].law
    assert (law.normal, law.friction) == (curve, friction)
    if friction:
        ratio = 2 * (1 - STEEL.poissons_ratio) / (2 - STEEL.poissons_ratio)  # Mindlin's
        assert law.tangential_penalty == pytest.approx(curve.stiffness * ratio, rel=1e-15)


@pytest.mark.parametrize(
    ("closure", "message"),
    [
        ("2e5", 'found 200000.0, expected one of { table = "file'),
        ("{ table = 'no.csv' }", "file 'no.csv' does not exist"),
        ("{ powr = { pressure = 1 } }", "found 'powr', .*'power'"),
        ("{ power = 3 }", r"found 3, expected power = { pressure = …, depth = …, exponent = … }"),
        ("{ power = { pressure = 1, depth = 1 } }", "'power' needs 'exponent'; give power = { pr"),
        (
            "{ exponential = { pressure = 1, clearence = 1 } }",
            "'exponential' has no 'clearence'; .*'clearance'",
        ),
        ("{ exponential = { pressure = 'a', clearance = 1 } }", "pressure of closure 'exponenti"),
        ("{ exponential = { pressure = 0, clearance = 1 } }", "pressure is 0; give a positive"),
        (KEYS["power"][0] + "\npenalty = 1e5", "found 'penalty', 'closure', which each give"),
    ],
)
def test_what_is_no_curve_is_refused_where_it_stands(tmp_path, closure, message):
    with pytest.raises(StudyError, match=message) as error:
        study(tmp_path, closure)
    assert "interface" in str(error.value)
    assert "closure" in str(error.value)


@pytest.mark.parametrize(
    ("layer", "message"),
    [
        ("a,b\n0,0\n", "the first line must name closure,pressure"),
        ("closure,pressure\n0,0\nx,1\n", "line 3: found 'x' in column 'closure'"),
        ("closure,pressure\n0,0\n1,2\n1,3\n", "after closure 1 with pressure 2 comes 1 with 3"),
        ("closure,pressure\n", "the curve has no lines below its column names"),
    ],
)
def test_files_that_hold_no_curve_are_refused_by_line(tmp_path, layer, message):
    with pytest.raises(StudyError, match=message):
        study(tmp_path, KEYS["table"][0], layer)
    with pytest.raises(FormatError, match=message):
        read_closure_table(tmp_path / "layer.csv")


GASKET = "closure,pressure,unloading\n0,0,20000\n0.001,3,20000\n0.004,30,40000\n"


@pytest.mark.long
def test_a_study_follows_a_gasket(tmp_path):
    """Down from where tightening left it: on the line of the largest closure, not on the table."""
    given = study(tmp_path, f"{{ gasket = 'layer.csv' }}\n{NO_REPORT}", GASKET)
    run(given, tmp_path / "out")
    case = read_results(tmp_path / "out/results.h5").cases["bending"]
    curve = build_loaded(load_model(given)).interfaces["joint"].law
    table = curve.pressure_of(-case.reference.gap.ravel())[0]
    pressure = case.reference.pressure.ravel()
    below = pressure < table - 0.01 * pressure.max()
    assert 0.1 < below.mean() < 0.9
    np.testing.assert_allclose(pressure[~below], table[~below], rtol=0, atol=0.02 * pressure.max())
    # Both solve for displacements to 1e-9 of the largest force, and the line is steep.
    assert case.methods["compliance"][0].accuracy.max_relative_error < 1e-7


SIZED = 'size = "M8"\ngrade = "8.8"\ntightening_factor = 1.4\npreload = 1e4'
RUBBED = "[requirement]\nslip_friction = 0.2\n"


@pytest.mark.long
def test_a_joint_with_a_gasket_is_judged_at_both_ends_of_its_preloads(tmp_path, monkeypatch):
    """Bolts and slip too: both were left out, and the bolt was told to be given a size."""
    given = study(tmp_path, f"{{ gasket = 'layer.csv' }}\n{NO_REPORT}{RUBBED}", GASKET)
    text = given.text.replace("preload = 1e4", SIZED).replace('"Fz", value', '"Fx", value')
    (tmp_path / "study.toml").write_text(text, encoding="utf-8")
    run(read_study(tmp_path / "study.toml"), tmp_path / "out")
    results = read_results(tmp_path / "out/results.h5")
    assert not results.warnings
    slip = results.assessment.interfaces["joint"].slip
    pulled = {name: abs(force) for name, force in slip.tangential_force.items()}
    assert pulled == pytest.approx({"bending": 100.0}, rel=1e-9)
    (judged,) = [check for check in results.assessment.checks if check.quantity == "yield"]
    assert (judged.outcome, judged.scatter) == ("met", "P_p,max")
    (loosened,) = [check for check in results.assessment.loosened if check.quantity == "slip"]
    assert loosened.scatter == "P_p,min"

    monkeypatch.setattr(JointJudge, "with_strength", fails)
    run(read_study(tmp_path / "study.toml"), tmp_path / "failed")
    failed = read_results(tmp_path / "failed/results.h5")
    (judged,) = [check for check in failed.assessment.checks if check.quantity == "yield"]
    assert (judged.outcome, judged.reason) == ("unknown", FAILED)


def fails(*_):
    raise ConvergenceError("nothing resists the bolts")


STEP = 'kind = "step"\nduration = 1e-3\nstep = 1e-4'


def test_a_study_refuses_a_gasket_in_motion(tmp_path):
    text = study(tmp_path, "{ gasket = 'layer.csv' }", GASKET).text
    (tmp_path / "study.toml").write_text(text.replace('kind = "static"', STEP), encoding="utf-8")
    given = read_study(tmp_path / "study.toml")
    model = build_loaded(load_model(given))
    with pytest.raises(StudyError, match="'joint' has the closure 'gasket', which depends on"):
        check_loads(given, model)


@pytest.mark.long
@pytest.mark.parametrize("friction", ["", "friction = 0.2", "friction = 0.2\nDURING"])
def test_a_study_runs_with_a_curve_and_says_so(tmp_path, friction):
    key, curve = KEYS["power"]
    given = study(tmp_path, f"{key}\n{friction.removesuffix('DURING')}")
    if friction.endswith("DURING"):
        given = given.model_copy(update={"friction_during_preload": False})
    run(given, tmp_path / "out")
    results = read_results(tmp_path / "out/results.h5")
    case = results.cases["bending"]
    expected = curve.pressure_of(-case.reference.gap.ravel())[0]
    largest = case.reference.pressure.max()
    # Pressures are right to 1e-9 of the largest force, and the curve is steep.
    np.testing.assert_allclose(
        case.reference.pressure.ravel(), expected, rtol=0, atol=1e-7 * largest
    )
    told = json.loads((tmp_path / "out/summary.json").read_text(encoding="utf-8"))
    assert told["interfaces"]["joint"]["penalty"] is None
    assert told["interfaces"]["joint"]["closure"] == {"power": asdict(curve)}
    report = (tmp_path / "out/report.html").read_text(encoding="utf-8")
    assert ">power<" in report
    loaded = reduced_model(results, "compliance", 0)
    assert loaded.contact.laws["joint"].normal == curve
    if not friction:  # what needs proportion says so, and the rest stands
        assert any("certified bounds: interface 'joint' has the law" in w for w in told["warnings"])


def test_models_take_curves_as_they_take_penalties():
    model = fy.lap_joint(element_size=10.0)
    curve = CURVES[1]
    assert model.with_closure(curve).interfaces["joint"].law == curve
    assert model.with_closure({"joint": curve}).interfaces["joint"].facts["closure"] == curve.name
    rubbing = model.with_friction(0.2, 3e5).with_closure(curve)
    assert rubbing.interfaces["joint"].law == Coulomb(curve, 0.2, 3e5)
    assert rubbing.with_friction(0.4, 2e5).interfaces["joint"].law == Coulomb(curve, 0.4, 2e5)
    assert rubbing.with_penalty(1e5).interfaces["joint"].law == Coulomb(Penalty(1e5), 0.2, 3e5)
    with pytest.raises(ModelError, match="no interface 'joynt'"):
        model.with_closure({"joynt": curve})
    spec = fy.InterfaceSpec(name="joint", closure=curve, penalty=1e5)
    assembly = model.assembly
    with pytest.raises(ModelError, match="it has a penalty and closure 'exponential'; give one"):
        fy.build_model(assembly, interfaces=[spec])
    given = fy.build_model(assembly, interfaces=[replace(spec, penalty="auto", friction=0.1)])
    assert given.interfaces["joint"].law.normal == curve


@pytest.mark.parametrize("normal", [Hard(), Penalty(2e5), *CURVES])
@pytest.mark.parametrize("friction", [0.0, 0.2])
def test_surfaces_hold_the_law(normal, friction):
    law = Coulomb(normal, friction, 1e5) if friction else normal
    model = fy.lap_joint(element_size=10.0, quadrature="nodal")  # which hard friction needs
    joint = model.interfaces["joint"].with_law(law)
    surface = contact_surface(joint, slice(0, joint.n_points), model.assembly.mesh.nodes, None)
    assert recorded_law(surface) == law
    assert (surface.penalty is None) == (normal in CURVES)
    for wrong in ('{"power": {"pressure": -1}}', "{}", '{"no": {}}', "["):
        with pytest.raises(ValueError):  # noqa: PT011 json has a message of its own
            recorded_law(replace(surface, closure=wrong))
