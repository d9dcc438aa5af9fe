"""The penalty doctor: what it measures, what it recommends, what it says."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.penalty_advice import UnitNames, recommend_penalty
from faying.assessment.penalty_sweep import PenaltySweep, penalty_sweep
from faying.exceptions import ModelError
from faying.interface.gap_field import with_gap_offset

LOADS = (fy.Load({"tip.Fz": -300.0}, name="down"), fy.Load({"tip.Mx": 8e3}, name="twist"))


def tightened(**options):
    return fy.preload(fy.lap_joint(element_size=5.0, **options), {"bolt": 10e3})


@pytest.fixture(scope="module")
def gauss():
    return tightened()


@pytest.fixture(scope="module")
def nodal():
    return tightened(quadrature="nodal")


@pytest.fixture(scope="module")
def nodal_sweep(nodal):
    return penalty_sweep(nodal, LOADS)


def test_a_row_is_the_full_solution_with_the_bolt_tightened_anew(gauss):
    sweep = penalty_sweep(gauss, LOADS, [1e4, 1e5])
    model = gauss.with_penalty(1e4)
    model = model.with_bolt_forces(fy.tighten(model, {"bolt": 10e3}).initial_forces)
    for column, load in enumerate(LOADS):
        full = fy.solve_static(model, load)
        # The final force is reached to 1e-12 from either start.
        assert sweep.max_pressure[0, column] == pytest.approx(full.max_pressure, rel=1e-9)
        assert sweep.penetration[0, column] == pytest.approx(full.max_penetration, rel=1e-9)
        # Penalty contact: p = c_n × penetration, Eq. (15.12).
        assert sweep.penetration[0, column] * 1e4 == pytest.approx(full.max_pressure, rel=1e-9)


def test_nodal_contact_converges_to_hard_contact_at_first_order(nodal_sweep):
    worst = nodal_sweep.deviation.max(axis=1)
    assert (np.diff(worst) < 0).all()
    # D = 1/(c_n w) is a first-order perturbation of H, so a decade takes a factor of ten.
    assert worst[-3] / worst[-1] == pytest.approx(10.0, rel=0.05)
    assert worst[-1] < 1e-3


def test_yardstick_is_hard_contact_at_the_pairs(nodal, nodal_sweep):
    hard = nodal.with_penalty(np.inf)
    hard = hard.with_bolt_forces(fy.tighten(hard, {"bolt": 10e3}).initial_forces)
    peaks = [fy.solve_static(hard, load).max_pressure for load in LOADS]
    np.testing.assert_allclose(nodal_sweep.hard_max_average, peaks, rtol=1e-8)


@pytest.mark.parametrize("shape", ["tet10", "hex20"])
def test_quadratic_elements_converge_to_hard_contact(shape):
    model = tightened(shape=shape, penalty="hard")
    sweep = penalty_sweep(model, LOADS)
    worst = sweep.deviation.max(axis=1)
    # As above; eight-node facets have a stiff penalty for hard, a tenth of which is left.
    assert worst[-4] / worst[-2] == pytest.approx(10.0, rel=0.1)
    assert worst[-1] < 1e-3
    near = int(np.abs(sweep.penalties - sweep.automatic).argmin())
    # D over H of one facet: 10 E/h gives up a tenth of the element below it, at most.
    assert worst[near] < 0.1
    peaks = [fy.solve_static(model, load).max_pressure for load in LOADS]
    if shape == "tet10":  # its nodal points are determined, and carry what is averaged
        np.testing.assert_allclose(sweep.hard_max_average, peaks, rtol=1e-8)


def test_gauss_points_are_compared_with_hard_contact_at_the_same_points(gauss):
    sweep = penalty_sweep(gauss, LOADS)
    worst = sweep.deviation.max(axis=1)
    assert (np.diff(worst) < 0).all()
    # Nothing but the penalty is left to differ, and a hundred times 10 E/h hardly does.
    assert worst[-1] < 0.01
    assert recommend_penalty(sweep).reached


def test_an_initial_gap_reaches_the_yardstick(nodal):
    x, y = nodal.interfaces["joint"].points.T[:2]
    shape = 1e-5 * (x**2 + y**2)
    crowned = nodal.with_interfaces({"joint": with_gap_offset(nodal.interfaces["joint"], shape)})
    stiff = penalty_sweep(crowned, LOADS, [1e9])
    # What is left is the penalty's own deviation, far below 1e-4 (see the first-order test).
    assert stiff.deviation.max() < 1e-4
    assert penalty_sweep(nodal, LOADS, [1e9]).hard_max_average[0] != pytest.approx(
        stiff.hard_max_average[0], rel=1e-2
    )


def test_errors_of_displacement_bases_grow_and_compliance_stays_exact(gauss):
    classic = fy.craig_bampton(gauss, normal_modes=5)
    basis = fy.jim_a(gauss, joint_modes=10, classic=classic)
    sweep = penalty_sweep(
        gauss,
        LOADS,
        [1e4, 1e5, 1e6],
        methods={
            "jim-a": lambda model: fy.reduce(model, basis),
            "compliance": lambda model: fy.reduce(model, classic, compliance=True),
        },
    )
    assert (np.diff(sweep.errors["jim-a"].max(axis=1)) > 0).all()
    assert sweep.errors["compliance"].max() < 1e-8  # static exactness, as for every model
    text = recommend_penalty(sweep).text
    assert "jim-a: largest pressure error" in text
    assert "compliance" in sweep.table
    assert len(sweep.table.splitlines()) == 4


def made_up(deviation, max_pressure=None):
    column = np.array(deviation, dtype=float)[:, None]
    ones = np.ones_like(column)
    return PenaltySweep(
        loads=("only",),
        penalties=10.0 ** np.arange(3, 3 + len(column)),
        automatic=1e4,
        max_pressure=ones if max_pressure is None else np.array(max_pressure, float)[:, None],
        max_average=ones,
        penetration=ones,
        deviation=column,
        rms_deviation=column,
        hard_max_average=np.ones(1),
        element_size=2.0,
        deflection=np.ones(1),
    )


def test_the_softest_within_the_tolerance_is_recommended():
    advice = recommend_penalty(made_up([0.5, 0.04, 0.01]), tolerance=0.05)
    assert (advice.penalty, advice.deviation, advice.reached) == (1e4, 0.04, True)
    assert "stiffness: 1e4, the softest" in advice.text
    assert "single contact points" not in advice.text


def test_the_closest_is_recommended_where_none_is_within():
    advice = recommend_penalty(made_up([0.5, 0.2, 0.3]), tolerance=0.05)
    assert (advice.penalty, advice.reached) == (1e4, False)
    assert "none stays within 5%" in advice.text


def test_a_penalty_that_roughens_the_pressure_is_not_recommended():
    sweep = made_up([0.2, 0.1, 0.01], max_pressure=[1.0, 1.1, 2.5])
    advice = recommend_penalty(sweep, tolerance=0.05)
    assert (advice.penalty, advice.reached) == (1e4, False)
    assert "whose peaks at single points are smooth" in advice.text


def test_advice_has_units_and_does_not_call_round_off_zero():
    sweep = replace(made_up([0.5, 0.04, 0.01]), errors={"compliance": np.full((3, 1), 1e-12)})
    units = UnitNames(penalty="N/mm³", length="mm")
    text = recommend_penalty(sweep, units=units).text
    assert "Recommended contact stiffness: 1e4 N/mm³, the softest" in text
    assert "penetration there: 1.00e+00 mm" in text
    assert "compliance: largest pressure error below 1e-5% at the recommended value" in text


def test_overconstrained_points_are_warned_of(gauss):
    advice = recommend_penalty(made_up([0.1, 0.01, 0.02], max_pressure=[1.0, 1.0, 2.5]))
    assert "grows to 2.5 times its nodal average" in advice.text
    # And on the real thing: Gauss points hold more points than displacements, nodal ones do not.
    stiff = penalty_sweep(gauss, LOADS, [1e5, 1e9])
    rough = (stiff.max_pressure / stiff.max_average).max(axis=1)
    assert rough[1] > 1.2 * rough[0]


def test_defaults_surround_the_automatic_penalty(nodal_sweep):
    # 10 E/h with E = 210 GPa and bricks of 5 mm.
    assert nodal_sweep.automatic == pytest.approx(10 * 210e3 / 5.0)
    assert nodal_sweep.penalties[0] == pytest.approx(nodal_sweep.automatic / 100)
    assert nodal_sweep.automatic in nodal_sweep.penalties
    assert nodal_sweep.element_size == pytest.approx(5.0, rel=0.05)
    np.testing.assert_allclose(
        nodal_sweep.relative_penetration * nodal_sweep.element_size, nodal_sweep.penetration
    )


@pytest.mark.parametrize("penalties", [[0.0], [np.inf], [], [-1.0, 1e4]])
def test_penalties_must_be_positive_and_finite(gauss, penalties):
    with pytest.raises(ModelError, match="positive and finite"):
        penalty_sweep(gauss, LOADS, penalties)


def test_an_open_joint_has_nothing_to_compare():
    loose = fy.lap_joint(element_size=5.0)
    with pytest.raises(ModelError, match="no contact pressure"):
        penalty_sweep(loose, [fy.Load({})], [1e4])
