"""Tightening, cycles and slip reserve with friction: balances, and the path solved otherwise."""

from dataclasses import asdict

import numpy as np
import pytest

import faying as fy
from faying.assessment.sliding import resistance_used
from faying.assessment.slip import OPEN, SLIP, STICK, slip_states
from faying.exceptions import ModelError
from faying.simulation.cycles import loop_area
from faying.simulation.path import moved_alone, path_inputs, path_start
from faying.simulation.path_steps import follow
from faying.simulation.start import last_of, released_state
from faying.simulation.tightening import tightened_joint
from faying.study.results.path_record import cycle_record

PULL = fy.Load({"tip.Fx": 1000.0})


@pytest.fixture(scope="module")
def smooth():
    return fy.lap_joint(element_size=5.0, penalty=1e6).with_bolt_forces({"bolt": 8e3})


@pytest.fixture(scope="module")
def rubbing(smooth):
    return smooth.with_friction(0.2, tangential_penalty=8e5)


@pytest.fixture(scope="module")
def tight(rubbing):
    return fy.solve_path(rubbing, [fy.Load()])


@pytest.fixture(scope="module")
def cycles(rubbing, tight):
    return fy.solve_cycles(rubbing, PULL, 0.8, tight, increments=10)


def test_bolts_end_at_their_forces_with_friction():
    model = fy.lap_joint(
        element_size=5.0,
        penalty=1e6,
        length=130.0,
        overlap=60.0,
        bolt_positions=((-15.0, 0.0), (15.0, 0.0)),
    ).with_friction(0.3)
    wanted = {"bolt-2": 6e3, "bolt-1": 8e3}
    found = tightened_joint(model, wanted, increments=4)
    for name, force in wanted.items():
        # The tolerance of the search is 1e-10 of the largest force.
        assert found.rest(model).bolt_force(name)[-1] == pytest.approx(force, rel=1e-9)
    smooth = fy.tighten(model.with_friction(0.0), wanted).initial_forces
    assert found.tightening.initial_forces["bolt-1"] != pytest.approx(smooth["bolt-1"], rel=1e-6)
    assert len(found.tightening.loads) >= 9  # four increments for each bolt, one for both
    basis = fy.craig_bampton(model, normal_modes=3)
    again = fy.solve_path(fy.reduce(model, basis, compliance=True), found.tightening.loads)
    # Round-off of S times the penalty, as along any path.
    np.testing.assert_allclose(
        again.traction[-1],
        found.rest(model).traction[-1],
        rtol=0,
        atol=1e-8 * again.max_pressure[-1],
    )


def test_tightening_without_friction_leaves_no_traction(smooth, rubbing):
    released = released_state(rubbing)
    expected = fy.solve_static(smooth)
    # Both condense one structure; 1e-12 is measured.
    np.testing.assert_allclose(
        released.pressure[0], expected.pressure, rtol=0, atol=1e-9 * expected.max_pressure
    )
    np.testing.assert_allclose(
        released.displacement("tip")[0], expected.displacement("tip"), rtol=1e-7, atol=1e-12
    )
    assert not released.traction.any()
    assert np.abs(released.slip).max() > 1e-5  # what moved counts as slip
    after = fy.solve_path(rubbing, [fy.Load()], initial=released)
    assert np.abs(after.traction).max() < 1e-8 * expected.max_pressure
    assert (slip_states(after, released).status != SLIP).all()


def test_reduced_models_are_released_into_the_same_state(rubbing):
    rom = fy.reduce(rubbing, fy.craig_bampton(rubbing, normal_modes=3), compliance=True)
    mine, exact = released_state(rom), released_state(rubbing)
    np.testing.assert_allclose(mine.slip, exact.slip, rtol=0, atol=1e-9 * np.abs(exact.slip).max())


def test_states_follow_from_the_law(rubbing, tight):
    path = fy.solve_path(rubbing, [fy.Load({"tip.Fx": f}) for f in (300.0, 700.0)], initial=tight)
    states = slip_states(path, tight)
    size, bound = np.linalg.norm(path.traction, axis=-1), 0.2 * path.pressure
    assert ((states.status == OPEN) == (path.contact_forces <= 0)).all()
    assert (size[states.status == STICK] <= bound[states.status == STICK] * (1 + 1e-9)).all()
    np.testing.assert_allclose(
        size[states.status == SLIP], bound[states.status == SLIP], rtol=1e-6, atol=1e-9
    )
    moved = np.linalg.norm(np.diff([tight.slip[-1], *path.slip], axis=0), axis=-1)
    assert moved[states.status == STICK].max() < 1e-9 * moved.max()
    np.testing.assert_allclose(states.open_share + states.stick_share + states.slip_share, 1.0)
    assert {STICK, SLIP} <= set(states.status.ravel().tolist())
    # Nothing slips where nothing is asked for, though points are on their bound.
    again = fy.solve_path(rubbing, [fy.Load({"tip.Fx": 700.0})], initial=path)
    assert slip_states(again, path).slip_share[-1] == 0


def test_without_friction_everything_slides(smooth):
    path = fy.solve_path(smooth, [PULL])
    states = slip_states(path)
    assert ((states.status == SLIP) == (path.contact_forces > 0)).all()
    assert states.slip_share.tolist() == [0.0]
    assert not states.macroslip.any()


def test_the_slip_reserve_is_where_single_increments_begin_to_slip(rubbing):
    released = released_state(rubbing)
    reserve = fy.slip_reserve(rubbing, PULL, released, share=0.3, increments=10)
    assert 0 < reserve.first_slip < reserve.share_slip < reserve.gross_slip
    steps = np.arange(1, 30) / 10
    for factor, share in ((reserve.first_slip, 0.0), (reserve.share_slip, 0.3)):
        before = [f for f in steps if f < factor]
        walked = [PULL.scaled(f) for f in (0.0, *before)]
        last = fy.solve_path(rubbing, walked, initial=released)
        shares = []
        for trial in (factor * (1 - 2e-3), factor):  # twice the precision of the search
            after = fy.solve_path(rubbing, [PULL.scaled(trial)], initial=last)
            shares.append(slip_states(after, last).slip_of_closed[-1])
        assert shares[0] <= share < shares[1] + 1e-12
    assert reserve.interface == "joint"
    assert 0 <= reserve.point < rubbing.contact.n_points


def test_a_reserve_along_a_path_takes_its_increments(rubbing, tight, monkeypatch):
    """To the last digit, and those of another load are followed anew."""
    loads = [fy.Load({"tip.Fx": 1000.0 * number / 10}) for number in range(1, 11)]
    relative = moved_alone(rubbing, path_inputs(rubbing, loads))
    solver, followed = rubbing.static_contact.increments, []
    path = list(follow(solver, relative, path_start(rubbing, tight)))

    def counted(*arguments):
        followed.append(arguments)
        return follow(*arguments)

    monkeypatch.setattr("faying.assessment.slip_reserve.follow", counted)
    alone, along, other = (
        (fy.slip_reserve(rubbing, load, tight, along=steps), len(followed))
        for load, steps in ((PULL, ()), (PULL, path), (PULL.scaled(2.0), path))
    )
    assert asdict(along[0]) == asdict(alone[0])
    assert along[1] - alone[1] == alone[1] - 10
    assert other[0].gross_slip == pytest.approx(alone[0].gross_slip / 2, rel=0.02)


def test_slip_sets_in_where_points_slip_that_tightening_left_stuck(smooth):
    """By single increments: what is on its bound after tightening does not count."""
    slippery = smooth.with_friction(0.02)  # tightening leaves eight points on their bounds
    tight = fy.solve_path(slippery, [fy.Load()])
    reserve = fy.slip_reserve(slippery, PULL, tight, increments=100)
    assert 5 * reserve.first_slip < reserve.onset < reserve.gross_slip
    before = [f for f in np.arange(1, 100) / 100 if f < reserve.onset]
    last = fy.solve_path(slippery, [PULL.scaled(f) for f in before], initial=tight)
    at_rest = np.linalg.norm(tight.traction[-1], axis=-1)
    stuck = at_rest < 0.02 * tight.pressure[-1] * (1 - 1e-6)
    assert np.count_nonzero(~stuck & (tight.contact_forces[-1] > 0)) > 0
    weights, shares = slippery.contact.weights, []
    # Twice the precision of the search, which goes there in smaller increments than one.
    for trial in (reserve.onset * (1 - 2e-3), reserve.onset * (1 + 2e-3)):
        after = fy.solve_path(slippery, [PULL.scaled(trial)], initial=last)
        status = slip_states(after, last).status[-1]
        slips = weights[(status == SLIP) & stuck].sum()
        shares.append(slips / weights[status != OPEN].sum())
    assert shares[0] <= 0.05 < shares[1] + 1e-12


@pytest.mark.long
def test_gross_slip_does_not_depend_on_the_increments():
    """Off the middle, across and twisted: single points turn around and stick on the way."""
    model = fy.lap_joint(element_size=5.0, bolt_positions=((-8.0, 3.0),))
    model = fy.preload(model, dict.fromkeys(model.bolts, 10e3))
    model = model.with_friction(0.2, tangential_penalty=8e5)
    tight = fy.solve_path(model, [fy.Load()])
    for forces in (
        {"tip.Fx": 1500.0, "tip.Fy": 400.0, "tip.Mx": 2e4},
        {"tip.Fy": 500.0, "tip.Mz": 2e4, "tip.Fz": -150},
    ):
        factors = [
            fy.slip_reserve(model, fy.Load(forces), tight, increments=n, largest=1.0).gross_slip
            for n in (5, 10, 20)
        ]
        # Twice the precision of the search and as much by the path; 1e-3 is measured.
        assert np.ptp(factors) < 4e-3 * factors[-1]


def test_at_gross_slip_friction_carries_what_it_can(rubbing):
    """Σ λ_t of a joint that slips along the load is μ Σ λ_n, but for points that turn aside."""
    released = released_state(rubbing)
    reserve = fy.slip_reserve(rubbing, PULL, released)
    path = fy.solve_path(rubbing, [PULL.scaled(reserve.gross_slip)], initial=released)
    carried = np.linalg.norm(path.traction[0].T @ rubbing.contact.weights)
    # Directions differ by some degrees about the hole: 2 % is measured in one large increment.
    assert carried == pytest.approx(0.2 * path.contact_forces.sum(), rel=0.05)
    assert not reserve.stopped


def test_a_joint_that_bends_slips_everywhere_and_holds(rubbing, tight):
    """Slip on one side of the bolt cancels slip on the other: nothing slides over its neighbour."""
    bending = fy.Load({"tip.Fz": 600.0})
    path = fy.solve_path(rubbing, [bending.scaled(f) for f in (0.5, 1.0, 1.5)], initial=tight)
    assert slip_states(path, tight).macroslip.all()
    # What friction carries along the interface is a tenth of what it could, at the largest load.
    carried = np.linalg.norm(path.traction[-1].T @ rubbing.contact.weights)
    assert carried < 0.2 * 0.2 * path.contact_forces[-1].sum()
    reserve = fy.slip_reserve(rubbing, bending, tight, increments=5, largest=1.5)
    assert reserve.share_slip < 1
    assert reserve.gross_slip is None


@pytest.mark.parametrize(
    ("component", "load", "least", "most"),
    [
        ("Fx", 2500.0, 0.89, 1.0),
        ("Fy", 600.0, 0.89, 1.0),
        ("Mz", 2e4, 0.89, 1.0),
        ("Fz", 400.0, 0.0, 0.02),
        ("Mx", -6e4, 0.0, 0.02),
        ("My", 8e4, 0.0, 0.02),
    ],
)
def test_sliding_and_bending_are_told_apart_when_everything_slips(
    rubbing, tight, component, load, least, most
):
    """As docs/how-to/follow_friction.md says of increments of a twentieth of these loads."""
    loads = [fy.Load({f"tip.{component}": load * factor}) for factor in np.arange(1, 16) / 20]
    path = fy.solve_path(rubbing, loads, initial=tight)
    at = int(slip_states(path, tight).macroslip.argmax())
    assert at > 0
    forces = path.contact_forces[at]
    pressed = np.flatnonzero(forces > 0)
    used = resistance_used(
        rubbing.interfaces["joint"].points[pressed],
        rubbing.contact.tangents[:, pressed],
        path.shear_forces[at][:, pressed],
        0.2 * forces[pressed],
    )
    assert least < used <= most


def test_cycles_repeat_and_close_their_energy(rubbing, cycles):
    assert cycles.stationary
    assert len(cycles.energies) >= 2
    record = cycle_record(cycles, PULL)
    energy = cycles.energies[-1]
    weights = rubbing.contact.weights
    # The same sum, but for increments that were halved: 4e-4 is measured.
    assert record.slip_work @ weights == pytest.approx(energy, rel=2e-3)
    # Loops close as far as cycles are stationary, to a thousandth; 6e-5 is measured.
    assert loop_area(cycles, PULL) == pytest.approx(energy, rel=1e-3)
    assert record.slip_range.max() > 0
    np.testing.assert_array_equal(record.fretting > 0, record.slip_range > 0)
    np.testing.assert_array_equal(
        last_of(cycles.cycle).contact_forces, cycles.cycle.contact_forces[-1]
    )


def test_a_cycle_that_sticks_loses_nothing(smooth):
    model = smooth.with_friction(10.0, tangential_penalty=8e5)
    found = fy.solve_cycles(model, PULL, 0.01, released_state(model), increments=3)
    assert found.stationary
    # A path of sticking points returns to round-off of the energy that goes in and out.
    assert found.energies[-1] < 1e-9


@pytest.mark.parametrize(
    ("change", "match"),
    [
        ({"share": 0.0}, r"share of slipping area is 0; give one above 0"),
        ({"increments": 0}, "found 0 increments"),
    ],
)
def test_reserves_of_nonsense_are_refused(rubbing, change, match):
    with pytest.raises(ModelError, match=match):
        fy.slip_reserve(rubbing, PULL, **change)


def test_what_cannot_slip_or_be_scaled_is_refused(smooth, rubbing):
    with pytest.raises(ModelError, match="no interface has friction"):
        fy.slip_reserve(smooth, PULL)
    shaking = fy.Load({"tip.Fx": fy.History(np.array([0.0, 1.0]), np.array([0.0, 1.0]))}, name="s")
    with pytest.raises(ModelError, match=r"load 's': tip\.Fx is a history; give a constant"):
        fy.slip_reserve(rubbing, shaking)
    with pytest.raises(ModelError, match="amplitude of -1 and 10 increments"):
        fy.solve_cycles(rubbing, PULL, -1.0)
