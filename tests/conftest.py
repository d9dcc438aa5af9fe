"""Models shared by the tests; built once, for models do not change."""

from pathlib import Path

import pytest

import faying as fy

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
def quick_demo(tmp_path_factory):
    """Folder that ``faying demo --quick`` leaves; read only, for exports and interop."""
    from faying.study.run import run
    from faying.study.schema import read_study

    out = tmp_path_factory.mktemp("quick-demo")
    demo = Path(fy.__file__).parent / "study" / "demo-quick.toml"
    study = read_study(demo)
    assert run(
        study.model_copy(update={"output": study.output.model_copy(update={"report": False})}), out
    ).converged
    return out
