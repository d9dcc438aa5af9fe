"""Models shared by the tests; built once, for models do not change."""

import gc
import sys
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import providers

import faying as fy

# The same examples in every run, so that what fails here fails everywhere and a change alone can
# turn a run red. New examples are looked for with `pytest tests/properties --hypothesis-profile
# searching`, and what that finds becomes a test. No example has a deadline: how long one takes
# says how busy the machine is. Examples of a test share its fixtures, as folders whose files each
# replaces.
settings.register_profile(
    "repeatable",
    derandomize=True,
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture],
)
settings.register_profile(
    "searching", settings.get_profile("repeatable"), derandomize=False, print_blob=True
)
settings.load_profile("repeatable")
# Beside random numbers Hypothesis tries those it reads in the sources of modules that are imported,
# so that examples would depend on what ran before; there is no public way to have none of them.
# tests/properties/test_examples.py notices where this stops working.
providers._get_local_constants = lambda: providers._local_constants


@pytest.hookimpl(wrapper=True)
def pytest_collection():
    """Collect without looking for garbage, which takes a third of the time and finds none."""
    gc.disable()
    try:
        return (yield)
    finally:
        gc.enable()


DATA = Path(__file__).parent / "data"


@pytest.fixture(scope="session")
def data():
    """Folder of the reference solutions; its README says how they were made."""
    return DATA


@pytest.fixture(scope="session")
def joint():
    """The seed's cantilever on a coarse mesh, tightened, with sticking area and damping."""
    model = fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="session")
def fine_joint():
    """The same on the default mesh."""
    model = fy.lap_joint(damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="session")
def classic(joint):
    """Craig-Bampton basis of ``joint``."""
    return fy.craig_bampton(joint, normal_modes=10)


@pytest.fixture(scope="session")
def pair():
    """A lap joint of two bolts."""
    model = fy.lap_joint(
        element_size=5.0, bolt_positions=((-10.0, 0.0), (10.0, 0.0)), hole_radius=None
    )
    return fy.preload(model, dict.fromkeys(model.bolts, 8e3))


@pytest.fixture
def call(monkeypatch, capsys):
    """Run the command line in this process; return status, standard output and error."""
    from faying import cli

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["faying", *map(str, arguments)])
        # Wide enough that rich does not wrap what tests look for.
        monkeypatch.setenv("COLUMNS", "200")
        with pytest.raises(SystemExit) as ended:
            cli.main()
        return ended.value.code or 0, *capsys.readouterr()

    return run


@pytest.fixture(scope="session")
def quick_demo(tmp_path_factory):
    """Folder of ``faying demo --quick`` with some of its methods; read only, for exports."""
    from faying.study.keys.schema import read_study
    from faying.workflow.run import run

    out = tmp_path_factory.mktemp("quick-demo")
    study = read_study(Path(fy.__file__).parent / "study" / "demo-quick.toml")
    methods = ("craig-bampton", "jim-b", "compliance", "jim-a+compliance", "jim-b+compliance")
    changes = {
        "output": study.output.model_copy(update={"report": False}),
        "reduction": study.reduction.model_copy(update={"methods": methods}),
        "validation": study.validation.model_copy(update={"unseen_loads": 0, "half_step": False}),
    }
    assert run(study.model_copy(update=changes), out)["converged"]
    return out
