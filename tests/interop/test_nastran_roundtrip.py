"""What is written is read back, to the digits of sixteen columns."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faying.exceptions import FormatError
from faying.io.nastran import read_deck, write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.assembly import (
    Assembly,
    AverageCoupling,
    Beam,
    BeamSection,
    Equation,
    Material,
    MatrixBlock,
    NodalLoads,
    PointMass,
    RigidCoupling,
    Spring,
    Support,
)
from faying.model.mesh import Mesh
from refusals import refuses

# Sixteen columns hold at least ten digits of any number a model contains.
DIGITS = 1e-10


def assert_same(found: Any, wanted: Any) -> None:
    """Compare values, leaving out what a deck does not keep."""
    if isinstance(wanted, np.ndarray):
        assert found.shape == wanted.shape
        np.testing.assert_allclose(found, wanted, rtol=DIGITS, atol=0)
    elif isinstance(wanted, float):
        assert found == pytest.approx(wanted, rel=DIGITS, abs=0)
    elif isinstance(wanted, (tuple, list)):
        assert len(found) == len(wanted)
        for a, b in zip(found, wanted, strict=True):
            assert_same(a, b)
    elif hasattr(wanted, "__dataclass_fields__"):
        for name in set(wanted.__dataclass_fields__) - {"name", "property", "ignored"}:
            if isinstance(wanted, Mesh) and name.endswith("_sets"):
                continue
            assert_same(getattr(found, name), getattr(wanted, name))
    elif isinstance(wanted, dict):
        assert list(found) == list(wanted)
        for key, value in wanted.items():
            assert_same(found[key], value)
    else:
        assert found == wanted


def there_and_back(assembly: Assembly, tmp_path: Path) -> Assembly:
    path = tmp_path / "joint.bdf"
    write_deck(assembly, path)
    assert max(len(line) for line in path.read_text().splitlines()) <= 80
    return read_deck(path)


@pytest.mark.parametrize(
    "options",
    [
        {},
        {"element": "standard", "washer": "rbe3"},
        {"shape": "hex20", "shear_flexible": False},
        {"shape": "tet10", "washer": "rbe3", "curvature": 0.002},
        {"shape": "tet4", "plates": 3},
        {"shape": "wedge6", "bolt_positions": ((-8.0, 0.0), (8.0, 0.0))},
        {"shape": "wedge15", "washer": "rbe3"},
    ],
    ids=lambda options: "-".join(map(str, options.values())) or "default",
)
def test_lap_joint(options: dict[str, Any], tmp_path: Path) -> None:
    assembly = lap_joint_assembly(element_size=5.0, **options).assembly
    back = there_and_back(assembly, tmp_path)
    if "shape" in options:  # no hex8 whose formulation a deck could tell
        back = replace(back, element=assembly.element)
    assert_same(back, assembly)


def everything() -> Assembly:
    """One of each, with numbers that need many digits."""
    random = np.random.default_rng(7)
    base = lap_joint_assembly(element_size=10.0, washer_radius=9.0).assembly
    mesh = replace(base.mesh, nodes=base.mesh.nodes + random.normal(0, 0.01, base.mesh.nodes.shape))
    last = len(mesh.nodes) - 1
    stiff = BeamSection(area=1 / 3, inertia_y=2 / 3, inertia_z=1e-3 / 7, torsion=0.0)
    aluminium = Material(name="7", youngs_modulus=7e4 / 3, poissons_ratio=1 / 3, density=2.7e-9)
    beam = Beam(
        id=9001, nodes=(0, 5), section=stiff, material=aluminium, orientation=(0.1, 1 / 3, 0.2)
    )
    inertia = ((1.0, -0.1, 0.2), (-0.1, 2.0, 0.3), (0.2, 0.3, 1 / 3))
    return replace(
        base,
        mesh=mesh,
        beams=(beam, *base.beams),
        springs=(
            Spring(id=9002, ends=((3, 0), (4, 0)), stiffness=1e5 / 7),
            Spring(id=9003, ends=((3, 2),), stiffness=1e9 / 7),
        ),
        masses=(PointMass(id=9004, node=last, mass=1 / 7, inertia=inertia),),
        rigid_couplings=(
            *base.rigid_couplings,
            RigidCoupling(id=9005, reference=last, nodes=np.array([20, 21]), components=(0, 2)),
        ),
        average_couplings=(
            AverageCoupling(
                id=9006,
                reference=last - 1,
                nodes=np.array([30, 31, 32]),
                weights=np.array([1.0, 1 / 3, 1 / 3]),
                reference_components=(0, 1, 2),
            ),
        ),
        equations=(
            Equation(id=4, terms=((40, 0, 1.0), (41, 0, -1 / 3), (42, 1, 2 / 7))),
            Equation(id=5, terms=((43, 0, 1.0), (44, 5, 0.5))),
        ),
        supports=(
            *base.supports,
            Support(id=2, nodes=np.array([50, 51]), components=(1,)),
        ),
        loads={
            "3": NodalLoads(nodes=np.array([60, 61]), forces=random.normal(0, 1, (2, 6))),
            "8": NodalLoads(nodes=np.array([62]), forces=np.array([[0, 0, -500.0, 0, 0, 0]])),
        },
    )


def test_everything_at_once(tmp_path: Path) -> None:
    assembly = everything()
    back = there_and_back(assembly, tmp_path)
    assert_same(replace(back, beams=tuple(sorted(back.beams, key=lambda b: -b.id))), assembly)
    # A second trip changes nothing any more.
    first = (tmp_path / "joint.bdf").read_text()
    write_deck(back, tmp_path / "again.bdf")
    assert_same(read_deck(tmp_path / "again.bdf"), back)
    assert first.count("GRID*") == len(assembly.mesh.nodes)


def test_load_sets_and_titles(tmp_path: Path) -> None:
    path = tmp_path / "a.bdf"
    assembly = replace(everything(), loads={"push": everything().loads["8"]})
    write_deck(assembly, path, title="A joint\nof plates")
    text = path.read_text()
    assert "TITLE = A joint of plates\n" in text
    assert "LOAD = 1\n" in text
    assert "$ load set 1 is 'push'" in text
    write_deck(everything(), path, loads="8")
    assert list(read_deck(path).loads) == ["8", "3"]
    refuses("no load set 'pull'; load sets are push", write_deck, assembly, path, loads="pull")


def test_support_along_turned_axes(tmp_path: Path) -> None:
    c, s = np.cos(0.3), np.sin(0.3)
    axes = np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]])
    base = lap_joint_assembly(element_size=10.0, washer_radius=9.0).assembly
    turned = Support(id=1, nodes=np.array([50, 51]), components=(0,), axes=axes)
    back = there_and_back(replace(base, supports=(turned,)), tmp_path)
    assert back.supports[0].nodes.tolist() == [50, 51]
    assert back.supports[0].axes is not None
    np.testing.assert_allclose(back.supports[0].axes, axes, atol=1e-12)  # 14 digits of cosines
    clash = (turned, Support(id=1, nodes=np.array([50]), components=(2,)))
    with pytest.raises(FormatError, match="node 51 is supported along turned axes"):
        write_deck(replace(base, supports=clash), tmp_path / "b.bdf")


def test_nothing_is_left_behind_when_writing_fails(tmp_path: Path) -> None:
    path = tmp_path / "a.bdf"
    path.write_text("old")
    empty = Assembly(mesh=Mesh(nodes=np.zeros((1, 3)), node_ids=[10**9]))
    refuses("node ids must lie between", write_deck, empty, path)
    assert ([p.name for p in tmp_path.iterdir()], path.read_text()) == (["a.bdf"], "old")
    refuses("cannot write", write_deck, everything(), tmp_path / "no" / "a.bdf")
    eye = np.eye(1)
    block = MatrixBlock(M=eye, K=eye, nodes=[0], components=[0])
    refuses("has matrices from another program", write_deck, replace(empty, matrices=block), path)
