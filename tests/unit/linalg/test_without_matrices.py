"""What is told of a model before its matrices are formed, beside what they say."""

from dataclasses import replace

import numpy as np
import pytest
from threadpoolctl import threadpool_limits

import faying as fy
from faying.cli import main
from faying.joint import expected_memory as memory
from faying.joint.lap_joint import lap_joint_assembly
from faying.linalg.backends import available_backends
from faying.model.assembly import Support
from faying.model.local_stiffness import rigid_stiffness, stiffness_at
from faying.model.rigid_motion import free_motions
from small_abaqus_deck import DECK

JOINT = lap_joint_assembly(element_size=5.0)
MESH = JOINT.assembly.mesh
CLAMP = MESH.node_sets["clamp"]
HINGE = CLAMP[MESH.nodes[CLAMP, 2] == MESH.nodes[CLAMP, 2].min()]
HELD = {
    "clamp": JOINT.assembly.supports,
    "hinge": (Support(id=1, nodes=HINGE, components=(0, 1, 2)),),
    "one node": (Support(id=1, nodes=CLAMP[:1], components=(0, 1, 2)),),
    "inclined": (Support(id=1, nodes=HINGE, components=(2,), axes=np.eye(3)[[1, 2, 0]]),),
    "nothing": (),
}


def built(supports, **options):
    joint = lap_joint_assembly(element_size=5.0, **options)
    return fy.build_model(
        replace(joint.assembly, supports=supports),
        interfaces=joint.interfaces,
        bolts=joint.bolts,
        boundaries=joint.boundaries,
    )


@pytest.mark.parametrize("washer", ["rbe2", "rbe3"])
@pytest.mark.parametrize("held", HELD)
def test_free_motions_are_those_of_the_whole_stiffness(held, washer):
    model = built(HELD[held], washer=washer)
    part = rigid_stiffness(model.assembly, model.dofs)
    found, expected = (free_motions(model.assembly, model.dofs, K).motions for K in (part, model.K))
    assert found.shape == expected.shape
    assert part.nnz < model.K.nnz / 2
    # Both bases are orthonormal, and eigenvectors of zero are as good as rounding over the gap.
    np.testing.assert_allclose(found @ (found.T @ expected), expected, atol=1e-9)


def test_rows_of_bolts_are_those_of_the_whole_stiffness():
    model = built(HELD["clamp"])
    ends = np.array(model.assembly.beams[0].nodes)
    rows = np.unique(model.dofs.transformation[(6 * ends[:, None] + np.arange(6)).ravel()].indices)
    part = stiffness_at(model.assembly, model.dofs, ends)
    # The same numbers summed in another order.
    size = abs(model.K[rows]).max()
    assert abs(part[rows] - model.K[rows]).max() <= 1e-14 * size
    assert part.nnz < model.K.nnz


def test_a_deck_is_checked_without_matrices(tmp_path, monkeypatch, capsys):
    def never(_assembly):
        pytest.fail("the matrices of the whole model were formed")

    monkeypatch.setattr("faying.joint.free_matrices.assemble_matrices", never)
    monkeypatch.setattr(memory, "MOST_COUNTED", 0)
    (tmp_path / "deck.inp").write_text(DECK)
    monkeypatch.setattr("sys.argv", ["faying", "check", str(tmp_path / "deck.inp")])
    with pytest.raises(SystemExit) as caught:
        main()
    assert not caught.value.code
    assert "free degrees of freedom" in capsys.readouterr().out


@pytest.mark.skipif("pardiso" not in available_backends(), reason="the law is of PARDISO")
@pytest.mark.parametrize(("shape", "friction"), [("hex8", 0.0), ("tet10", 0.0), ("tet10", 0.2)])
def test_expected_memory_is_that_counted_within_a_factor_of_two(shape, friction, monkeypatch):
    monkeypatch.setattr(memory, "MOST_COUNTED", 0)
    model = built(HELD["clamp"], shape=shape)
    if friction:
        model = model.with_friction(friction)
    # Told to take two threads, as others in this process may have left it, MKL holds 17 MB more.
    with threadpool_limits(1):
        found, counted = memory.expected_memory(model), model.structure.factor_memory
    assert not found.counted
    assert 0.5 < found.factor / counted.factor < 2
    assert 0.5 < found.peak / counted.peak < 2
