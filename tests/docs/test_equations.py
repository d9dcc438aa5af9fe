"""Equations (15.24), (15.26) and (15.30) as they stand, on a coarse cantilever."""

import numpy as np
import pytest

import faying as fy
from faying.reduction.basis import ModeKind
from faying.reduction.jim_a import unit_pressure_loads

BOX = fy.LoadBox(ranges={"tip.Fz": (-500.0, 500.0), "tip.Mx": (-2e4, 2e4)}, levels=3)


@pytest.fixture(scope="module")
def training(joint):
    return fy.static_snapshots(joint, BOX.static_loads(joint))


def test_joint_modes_are_static_shapes_of_contact_forces(joint, classic):
    """K φ is zero but at the interface, at the boundary that is held, and where earlier shapes act.

    Only the span counts: orthonormalization mixes normal modes and bolt shapes into φ.
    """
    held = joint.structure.solve_held(unit_pressure_loads(joint, 200))
    basis = fy.jim_a(joint, joint_modes=8, classic=classic)
    inner = basis.of_kind(ModeKind.NORMAL, ModeKind.BOLT, ModeKind.JOINT)
    before = classic.of_kind(ModeKind.NORMAL, ModeKind.BOLT)
    span = np.hstack([before, held])
    residual = inner - span @ np.linalg.lstsq(span, inner, rcond=None)[0]
    # Round-off times the condition of two hundred neighbouring loads.
    assert np.abs(residual).max() < 1e-8 * np.abs(inner).max()


def test_method_b_reproduces_its_training(joint, classic, training):
    """With all its modes the basis holds every training force, hence every training solution."""
    everything = fy.jim_b(joint, training, joint_modes=training.shape[1], classic=classic)
    rom = fy.reduce(joint, everything)
    loads = BOX.static_loads(joint)
    fast, full = fy.solve_static_cases(rom, loads), fy.solve_static_cases(joint, loads)
    # The Ritz solution is the exact one where the basis contains it; shapes whose energy is 1e-8
    # of the largest are dropped.
    assert fy.compare(fast, full).max_relative_error < 1e-5
