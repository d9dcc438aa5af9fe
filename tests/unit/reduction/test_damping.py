"""C of full and reduced models: in proportion to M and K, and dampers beside."""

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.joint.free_matrices import FreeMatrices
from faying.reduction.recovery import at_ports
from lap_joints import tiny_lap

ALPHA, BETA = 160.0, 5e-7


@pytest.fixture(scope="module")
def damped():
    """A lap joint with a damper to ground at every degree of freedom, all of another strength."""
    model = tiny_lap(damping=fy.Rayleigh(alpha=ALPHA, beta=BETA))
    strength = np.random.default_rng(0).uniform(0.0, 0.1, model.K.shape[0])
    matrices = FreeMatrices(
        form=lambda: (model.M, model.K, sp.diags_array(strength).tocsr()), damping=model.damping
    )
    return replace(model, structure=replace(model.structure, matrices=matrices)), strength


def test_dampers_reach_full_and_reduced_models_and_recovery(damped):
    model, strength = damped
    C = ALPHA * model.M + BETA * model.K + sp.diags_array(strength)
    # The same sums in another order: round-off of their largest terms.
    close = {"rtol": 1e-13, "atol": 1e-15 * np.abs(C.data).max()}
    np.testing.assert_allclose(model.C.toarray(), C.toarray(), **close)

    basis = fy.craig_bampton(model, normal_modes=4)
    rom, phi = fy.reduce(model, basis), basis.vectors
    wanted = phi.T @ (C @ phi)
    size = np.sqrt(np.outer(np.diag(wanted), np.diag(wanted)))
    assert np.abs((rom.C - wanted) / size).max() < 1e-12  # round-off of sums over all nodes
    recovered = at_ports(model, model.structure.solve(C @ phi))
    # K⁻¹KΦ is Φ but for the round-off of a back-substitution, 1e-12 of what moves most.
    np.testing.assert_allclose(
        rom.recovery_damping, recovered, rtol=1e-9, atol=1e-11 * np.abs(recovered).max()
    )


def test_a_stiffer_model_is_damped_in_proportion(damped):
    model, _ = damped
    added = sp.diags_array(np.full(model.K.shape[0], 1e3)).tocsr()
    stiffer = model.with_stiffness(added, stuck={})
    difference = (stiffer.C - model.C - BETA * added).data
    assert np.abs(difference).max() <= 1e-15 * np.abs(model.C.data).max()  # round-off


def test_reductions_do_not_form_the_damping_matrix():
    model = tiny_lap()
    fy.reduce(model, fy.craig_bampton(model, normal_modes=2), compliance=True)
    assert "C" not in vars(model.structure.matrices)
