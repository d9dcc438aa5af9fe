"""Checks of bolts: by hand, with the case and instant that decide."""

from dataclasses import replace

import numpy as np
import pytest

import faying as fy
from faying.assessment.joint_record import CaseState
from faying.assessment.strength.checks import strength_checks, stripping_force
from faying.assessment.strength.fatigue import miner_sums, rainflow
from faying.assessment.strength.preload_ends import PreloadEnd, preload_ends
from faying.assessment.strength.thread import (
    largest_amplitude,
    normal_stresses,
    tightening_stress,
    working_stress,
)
from faying.assessment.strength.tightening import PreloadRange, force_of_utilisation

M10 = fy.Thread(diameter=10.0, pitch=1.5, grade="8.8", friction=0.12)
NO_PRESSURE = np.zeros((1, 1))


def state(forces, moments=None, times=None):
    bent = {} if moments is None else {"b": np.asarray(moments, dtype=float)}
    return CaseState(
        pressure=NO_PRESSURE,
        bolt_forces={"b": np.asarray(forces, dtype=float)},
        bolt_moments=bent,
        times=times,
    )


def checked(cases, thread=M10, preload=25e3, repetitions=None):
    bent = any(one.bolt_moments for one in cases.values())
    rest = state([preload], np.zeros((1, 2, 2)) if bent else None)
    end = PreloadEnd(name="", rest=rest, cases=cases)
    found = strength_checks({"b": thread}, [end], "mm-t-s", repetitions)
    return {one.quantity: one for one in found}


def test_a_bolt_beyond_its_yield_stress_is_told_with_its_case_and_instant():
    # 25 kN and 80 N m on an M10: 431 MPa axial, 1283 MPa of bending.
    moments = np.zeros((3, 2, 2))
    moments[1, 0, 1] = 80e3
    cases = {
        "rest": state([25e3]),
        "swing": state([25e3, 25e3, 26e3], moments, np.array([0.0, 0.1, 0.2])),
    }
    found = checked(cases)["yield"]
    d_s = M10.stress_diameter
    normal = 25e3 / (np.pi / 4 * d_s**2) + 80e3 / (np.pi / 32 * d_s**3)
    d_2 = M10.pitch_diameter
    twist = 25e3 * (1.5 / (2 * np.pi) + d_2 / 2 * 0.12 / np.cos(np.pi / 6))
    shear = twist / (np.pi / 16 * d_s**3) / 2
    assert (found.outcome, found.case, found.instant) == ("not met", "swing", 0.1)
    assert found.value == pytest.approx(np.sqrt(normal**2 + 3 * shear**2), rel=1e-12)  # round-off
    assert found.utilisation == pytest.approx(found.value / 640.0, rel=1e-12)
    assert (found.part, found.kind, found.unit, found.limit) == ("b", "bolt", "MPa", 640.0)


@pytest.mark.parametrize(
    ("force", "at_rest", "loaded", "reason"),
    [
        (25e3, 0.0, 80e3, "friction of the faces"),
        (25e3, 80e3, 80e3, "tightening alone bends it"),
        (60e3, 80e3, 80e3, "take a larger size"),
    ],
)
def test_what_to_do_about_a_bolt_that_yields_follows_from_what_stresses_it(
    force, at_rest, loaded, reason
):
    rest, case = (state([force], np.full((1, 2, 2), moment)) for moment in (at_rest, loaded))
    end = PreloadEnd(name="", rest=rest, cases={"load": case})
    checks = strength_checks({"b": M10}, [end], "mm-t-s")
    assert reason in next(check.reason for check in checks if check.quantity == "yield")


def test_amplitudes_do_not_depend_on_how_the_model_is_turned():
    """Against all pairs of instants; of fibres five degrees apart they varied by 1.5e-4."""
    rng = np.random.default_rng(3)
    forces, moments = 2e4 + 1e3 * rng.standard_normal(6), 2e4 * rng.standard_normal((6, 2, 2))
    pairs = [
        (forces[i] - forces[j]) / M10.stress_area
        + np.linalg.norm(moments[i] - moments[j], axis=-1).max() / M10.section_modulus
        for i in range(6)
        for j in range(6)
    ]
    for angle in np.radians([0.0, 1.0, 2.5]):
        c, s = np.cos(angle), np.sin(angle)
        stresses = normal_stresses(M10, forces, moments @ np.array([[c, s], [-s, c]]))
        assert largest_amplitude(stresses) == pytest.approx(max(pairs) / 2, rel=1e-12)


def test_cases_that_are_not_solved_anew_are_bent_as_much_more_as_they_are_tightened():
    """In proportion, as of a joint whose contact does not change, not by the load's share."""
    tight, added = np.array([[[3e3, 0.0], [4e3, 1e3]]]), np.array([[[500.0, 200.0], [0.0, 0.0]]])
    rest, case = state([10e3], tight), state([10.2e3], tight + added)
    ends = preload_ends(None, rest, {"load": case}, {}, {"b": PreloadRange(variation=0.25)})
    for end, factor in zip(ends, (0.75, 1.25), strict=True):
        found = end.cases["load"]
        assert found.bolt_forces["b"] == pytest.approx([10e3 * factor + 200.0], rel=1e-14)
        wanted = tight * factor + added
        assert found.bolt_moments["b"] == pytest.approx(wanted, rel=1e-14)
        assert end.rest.bolt_moments["b"] == pytest.approx(tight * factor, rel=1e-14)


def test_a_joint_tells_the_strength_of_its_bolts():
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    loads = [fy.Load({"tip.Fz": -100.0}, name="bend")]
    found = fy.assess(joint, loads, paths=False, threads={"bolt": M10})
    (check,) = (one for one in found.checks if one.quantity == "yield")
    stress = found.bolts["bolt"].thread
    assert check.outcome == "met"
    assert check.utilisation == pytest.approx(1 / stress.safety, rel=1e-12)  # the same formula
    assert fy.assess(joint, loads, paths=False).checks == ()


def test_rainflow_counts_the_example_of_its_standard():
    # ASTM E1049-85, figure 6: ranges 3, 4, 6, 8, 9 with 0.5, 1.5, 0.5, 1, 0.5 cycles
    ranges, counts = rainflow(np.array([-2.0, 1, -3, 5, -1, 3, -4, 4, -2])).T
    found = {size: counts[ranges == size].sum() for size in np.unique(ranges)}
    assert found == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}


def test_rainflow_sees_reversals_only():
    coarse = np.array([0.0, 4.0, 1.0, 3.0, 0.0])
    fine = np.interp(np.linspace(0, 4, 41), np.arange(5), coarse)
    assert np.array_equal(rainflow(np.repeat(fine, 2)), rainflow(coarse))
    assert rainflow(np.ones(5)).shape == (0, 2)


def test_miners_sum_by_hand():
    # 3 half ranges of 100 to and fro: 100 = 2 x 50, endures 2e6 (50/100)^3 = 2.5e5 cycles
    history = np.array([0.0, 200.0, 0.0, 60.0, 0.0])[:, None]
    assert miner_sums(history, 1e5, 50.0).max() == pytest.approx(1e5 / 2.5e5, rel=1e-14)  # 30 < 50
    assert miner_sums(history, 1e5, 100.0).max() == 0.0


def test_amplitudes_are_judged_from_rest_and_counted_where_repetitions_are_known():
    thread = fy.Thread.named("M10", "8.8")
    limit = 0.85 * (15 + 45)  # M10: 51 MPa
    cases = {"pull": state([25e3 + 100 * thread.stress_area])}
    found = checked(cases, thread)["fatigue"]
    assert found.value == pytest.approx(50.0, rel=1e-13)
    assert (found.outcome, found.limit) == ("met", pytest.approx(limit, rel=1e-14))
    cases["push"] = state([25e3 - 100 * thread.stress_area])
    unsure = checked(cases, thread)["fatigue"]
    assert (unsure.outcome, unsure.utilisation) == ("unknown", None)
    assert "borne 300000 times" in unsure.reason  # 2e6 (51/100)^3 = 2.65e5
    worn = checked(
        {"pull": state([25e3 + 200 * thread.stress_area])}, thread, repetitions={"pull": 1e6}
    )
    damage = worn["fatigue, Miner's sum"]
    assert damage.value == pytest.approx(1e6 / (2e6 * (limit / 100) ** 3), rel=1e-12)
    assert (damage.outcome, damage.case) == ("not met", "pull")
    hard = {"pull": state([45e3]), "lift": state([44e3]), "rest": state([25e3])}
    end = PreloadEnd(name="P_p,min", rest=state([25e3]), cases=hard)
    often = dict.fromkeys(hard, 1e5)
    for solved, told in (({"pull"}, ", 1 of 2 cases by their nominal amplitudes"), (hard, "")):
        ends = [replace(end, solved=frozenset(solved))]
        (counted,) = (
            one for one in strength_checks({"b": thread}, ends, "mm-t-s", often)
            if one.quantity == damage.quantity
        )  # fmt: skip
        assert counted.scatter == f"P_p,min{told}"


def test_pressure_under_the_head_and_stripping_by_hand():
    thread = fy.Thread.named("M10", "8.8", pressure_limit=300.0, engagement=8.0)
    found = checked({"pull": state([30e3])}, thread)
    pressed = found["pressure under the head"]
    assert pressed.value == pytest.approx(30e3 / (np.pi / 4 * (14.63**2 - 11.0**2)), rel=1e-12)
    assert pressed.outcome == "not met"
    # Basic profile of M10: D1 = 8.376, d2 = 9.026, to three decimals
    area = np.pi * 8.376 * 8.0 / 1.5 * (1.5 / 2 + (9.026 - 8.376) / np.sqrt(3))
    assert stripping_force(thread, 8.0, 800.0) == pytest.approx(0.6 * 800 * area, rel=1e-3)
    assert found["stripping"].utilisation == pytest.approx(30e3 / (480 * area), rel=1e-3)


def test_torsion_is_that_of_the_force_before_losses():
    rest = state([20e3])
    end = PreloadEnd(name="", rest=rest, cases={"rest": rest}, tightened={"b": 25e3})
    found = {one.quantity: one for one in strength_checks({"b": M10}, [end], "mm-t-s")}
    assert found["tightening"].value == tightening_stress(M10, 25e3)
    assert found["yield"].value == working_stress(M10, 25e3, np.array([20e3]), None)[0]


def test_scattered_preloads_are_solved_at_both_ends():
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": 10e3})
    load = fy.Load({"tip.Fz": -400.0}, name="bend")
    scatter = fy.PreloadScatter(tightening_factor=1.6, samples=1)
    limited = fy.Thread.named("M10", "8.8", friction=0.12, pressure_limit=100.0)
    found = fy.assess(joint, [load], paths=False, threads={"bolt": limited}, scatter=scatter)
    checks = {one.quantity: one for one in found.checks}
    gamma = 0.6 / 2.6
    ends = {}
    for name, force in (("P_p,min", 10e3 * (1 - gamma)), ("P_p,max", 10e3 * (1 + gamma))):
        tightened = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": force})
        ends[name] = fy.assess(tightened, [load], paths=False, threads={"bolt": limited})
    worst = {name: {c.quantity: c for c in one.checks} for name, one in ends.items()}
    assert checks["yield"].scatter == "P_p,max"
    for quantity in ("yield", "fatigue", "pressure under the head"):
        expected = max(one[quantity].value for one in worst.values())
        # Tightened anew, once by one contact problem and once by steps: their tolerance is 1e-10.
        assert checks[quantity].value == pytest.approx(expected, rel=1e-8)


def test_tightening_twists_by_all_of_the_torsion():
    # Where tightening uses 90 % of the yield stress, by definition
    thread = fy.Thread.named("M8", "8.8", friction=0.12)
    force = force_of_utilisation(thread, 0.9, "mm-t-s")
    found = checked({"rest": state([force])}, thread, force)["tightening"]
    assert found.utilisation == pytest.approx(0.9, rel=1e-14)
    assert checked({"rest": state([force])}, thread, 1.2 * force)["tightening"].outcome == "not met"


RATED = [("A2-80", "unknown"), ("4.6", "unknown"), ("8.8", "met"), ("10.9", "met")]


@pytest.mark.parametrize(("grade", "outcome"), RATED)
def test_endurance_is_known_of_strong_steels(grade, outcome):
    found = checked({"rest": state([1e3])}, fy.Thread.named("M10", grade), 1e3)
    assert found["fatigue"].outcome == outcome


def test_clamp_forces_are_judged_where_preloads_are_least():
    load = fy.Load({"tip.Fz": 600.0}, name="pull")
    scatter = fy.PreloadScatter(tightening_factor=1.6, samples=1)
    least = 10e3 * 2 / 2.6
    joint, loose = (
        fy.preload(fy.lap_joint(element_size=5.0), {"bolt": force}) for force in (10e3, least)
    )
    (free,) = fy.assess(joint, [load], paths=False, scatter=scatter).checks
    demand = fy.Requirements(min_clamp_force=7e3)
    (held,) = fy.assess(joint, [load], demand, paths=False, scatter=scatter).checks
    left = float(fy.solve_static(loose, load).contact_force("joint"))
    rest = float(fy.solve_static(loose).contact_force("joint"))
    assert (free.quantity, free.scatter, free.case) == ("clamp loss", "P_p,min", "pull")
    # Tightened once by steps and once at once: 1e-10 of the force
    assert free.utilisation == pytest.approx(1 - left / rest, rel=1e-7)
    assert held.value == pytest.approx(left, rel=1e-8)
    assert (held.quantity, held.required) == ("clamp force", True)
    assert held.outcome == ("met" if left >= 7e3 else "not met")


def test_ends_bound_the_force_of_a_single_bolt_that_is_not_bent():
    def bounds(rest, pulled):
        end = PreloadEnd(name="P_p,max", rest=rest, cases={"p": pulled}, solved=frozenset({"p"}))
        (found,) = (
            c for c in strength_checks({"b": M10}, [end], "mm-t-s") if c.quantity == "yield"
        )
        return found.bound

    alone, bent = state([20e3]), state([20e3], np.zeros((1, 2, 2)))
    assert bounds(alone, alone)
    assert not bounds(bent, bent)
    several = replace(alone, bolt_forces={**alone.bolt_forces, "c": np.array([1e3])})
    assert not bounds(several, several)


def test_the_force_of_a_single_bolt_rises_with_its_preload():
    # What the bound rests on, also where the load opens the joint
    load = fy.Load({"tip.Fz": 900.0})
    joints = [
        fy.preload(fy.lap_joint(element_size=5.0), {"bolt": f}) for f in (4e3, 6e3, 9e3, 12e3)
    ]
    forces = [float(fy.solve_static(one, load).bolt_force("bolt")) for one in joints]
    assert np.all(np.diff(forces) > 0)
