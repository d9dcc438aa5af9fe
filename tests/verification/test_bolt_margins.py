"""Worked numbers of public standards: NASA-STD-5020B and ECSS-E-HB-32-23A §7.14.

Each figure is that of the document, to the digits it gives; tolerances are half of the last one,
or what rounded inputs make of it.
"""

import numpy as np
import pytest

import faying as fy
from faying.assessment.opening import opening_factors
from faying.assessment.strength.checks import Safeties, with_safeties
from faying.assessment.strength.margins import (
    SHANK,
    contact_margin,
    interaction,
    slip_margin,
    torque_tests,
)
from faying.assessment.strength.nasa_std_5020b import DesignFactors, margin_checks
from faying.assessment.strength.thread import torsion_of
from faying.assessment.strength.tightening import PreloadRange, force_of_torque
from faying.contact.laws import Coulomb
from faying.exceptions import ModelError
from faying.joint.tangential import tangential_rows
from faying.model.bolt import Bolt
from faying.reduction.projection import contact_surfaces
from faying.simulation.preload import tighten
from small_system import small_system


def stiffness_factor(bolt, clamped):
    """Return φ, (9)."""
    return bolt / (bolt + clamped)


def separation_load(preload, share):
    """Return P'_sep of n φ, (11)."""
    return preload / (1 - share)


TABLE_6 = np.array(
    [
        7760, 4010, 3587, 4635, 4920, 3797, 4462, 4940, 6220, 4780,
        7229, 4310, 3900, 4322, 4475, 3812, 4132, 4219, 6100, 4685,
        6080, 4291, 3054, 4804, 3910, 3303, 4090, 4550, 6062, 5180,
    ],
    dtype=float,
)  # fmt: skip


def test_torque_tests_of_table_6():
    found = torque_tests(TABLE_6, 450.0, 0.375)
    assert found.nominal == pytest.approx(4721, abs=0.5)
    assert found.nut_factor == pytest.approx(0.254, abs=5e-4)
    assert found.most == pytest.approx(0.644, abs=5e-4)
    assert found.least == pytest.approx(0.353, abs=5e-4)
    assert found.deviation == pytest.approx(1097, abs=0.5)
    assert found.statistical == pytest.approx(0.498, abs=5e-4)
    with pytest.raises(ModelError, match="two are the least"):
        torque_tests(TABLE_6[:1], 450.0, 0.375)


def test_extreme_preloads_of_equations_1_to_5():
    # Section 4.3.1: 40 ± 2 N m give c = 1.05 and 0.95
    scatter = PreloadRange(
        variation=0.25, loss=0.05, creep=10.0, gained=30.0, lost=20.0,
        least_control=0.95, most_control=1.05,
    )  # fmt: skip
    assert scatter.most(1000.0) == pytest.approx(1.05 * 1.25 * 1000 + 30, rel=1e-14)
    initial = 0.95 * 0.75 * 1000
    assert scatter.least(1000.0) == pytest.approx(initial * 0.95 - 10 - 20, rel=1e-14)
    together = 0.95 * (1 - 0.25 / 2) * 1000
    assert scatter.least(1000.0, fasteners=4) == pytest.approx(together * 0.95 - 30, rel=1e-14)


def test_two_fittings_of_a_12_3():
    share = 0.5 * 0.314
    assert separation_load(2090, share) == pytest.approx(2479, abs=0.5)
    assert 2 * separation_load(2090, share) == pytest.approx(4958, abs=1.0)
    assert separation_load(2090 + 3135, share) == pytest.approx(6198, abs=0.5)
    # Its contact model: the first bolt is apart at about 5100 lb, between the sums by hand.
    assert 2 * separation_load(2090, share) < 5100 < separation_load(2090 + 3135, share)


def apart(preload, share):
    """Return the load that parts a fitting: it enters half-way up members of two springs each."""
    member, head = 2e6, np.array([0.0, 1.0])
    stiffness = share / (1 - share) * member / 2
    bolt = Bolt(
        name="bolt", elongation=head, stiffness=stiffness, initial_force=preload / (1 - share)
    )
    K = member * np.array([[1.0, -1.0], [-1.0, 1.0]]) + stiffness * np.outer(head, head)
    fitting = small_system(
        np.eye(2), np.zeros((2, 2)), K, [1.0, 0.0], gap=0.0, stiffness=member, bolts=[bolt]
    )
    assert fy.solve_static(fitting).bolt_force("bolt") == pytest.approx(preload, rel=1e-12)
    (inputs,) = fy.Load({"mass.Fx": 1e3}).inputs(fitting, np.zeros(1))
    return 1e3 * opening_factors(fitting, inputs, {"stop": np.array([True])}).opened["stop"]


def test_contact_parts_two_fittings_at_the_loads_of_a_12_3():
    loose, tight = apart(2090.0, 0.314), apart(3135.0, 0.314)
    assert loose == pytest.approx(2479, abs=0.5)
    assert 2 * loose == pytest.approx(4958, abs=1.0)
    assert loose + tight == pytest.approx(6198, abs=0.5)


def test_slip_of_a_12_4():
    # (85) with the preloads of Figure 24 (three of 3135 lb, one of 2090 lb) and mu = 0.1 lies
    # between the loads at which its contact model slips first and second.
    clamp = 3 * 3135.0 + 2090.0
    load = 0.1 * clamp
    assert 1000 < load < 1500
    assert slip_margin(0.1, clamp, load) == pytest.approx(0.0, abs=1e-14)


def test_bolt_and_members_of_the_public_textbook_example():
    assert stiffness_factor(2.3892e6, 4.7253e6) == pytest.approx(0.3358, abs=5e-5)


def ecss(torque, prevailing, thread_friction, head_friction):
    """Return F_M, and the stress and torsion that tightening leaves with the prevailing torque."""
    thread = fy.Thread.named(
        "M6", "8.8", friction=thread_friction, head_friction=head_friction, head_diameter=8.25
    )
    force = force_of_torque(thread, torque - prevailing)
    more = prevailing / (np.pi / 16 * thread.stress_diameter**3)
    return force, force / thread.stress_area, torsion_of(thread, force) + more


@pytest.mark.parametrize(
    ("torques", "frictions", "listed"),
    [
        ((13.0e3, 2.0e3), (0.176, 0.296), (5717.6, 284.1, 236.3, 498.3)),
        ((14.3e3, 0.4e3), (0.086, 0.176), (12078.1, 600.2, 217.2, 708.3)),
    ],
)
def test_preloads_and_stresses_of_ecss_7_14(torques, frictions, listed):
    force, normal, shear = ecss(*torques, *frictions)
    # Friction and the diameter under the head are known to three digits.
    assert (force, normal, shear) == pytest.approx(listed[:3], rel=1e-3)
    assert np.hypot(normal, np.sqrt(3) * shear) == pytest.approx(listed[3], rel=1e-3)


def test_extreme_preloads_and_gapping_of_ecss_7_14():
    phi = stiffness_factor(1 / 2.902e-6, 1 / 1.044e-6)
    assert phi == pytest.approx(0.265, abs=5e-4)
    # Embedding is 5 % of the larger preload there, and -17 K lower both.
    assert pytest.approx(603.9, abs=0.05) == 0.05 * 12078.1
    most = PreloadRange(gained=-112.0).most(12078.1)
    least = PreloadRange(lost=112.0, creep=603.9).least(5717.6)
    assert most == pytest.approx(11966.1, abs=0.06)
    assert separation_load(least, 0.5 * phi) == pytest.approx(5764.3, rel=2e-4)  # of phi
    assert separation_load(most, 0.5 * phi) == pytest.approx(13790.6, rel=2e-4)


def test_margins_of_tension_by_hand():
    # n φ = 0.8: ruptured at (10000 - 6000) / 0.8 = 5000, (10), before 6000 / 0.2 = 30000, (11).
    tension = 6e3 + 0.8 * 4e3  # (8)
    assert contact_margin(10e3, 6e3, tension) == pytest.approx(5e3 / 4e3 - 1, rel=1e-14)  # (7)
    assert contact_margin(10e3, 6e3, 5e3) == np.inf
    assert contact_margin(10e3, 11e3, 12e3) == -1.0


def test_interaction_and_slip_by_hand():
    assert interaction(0.5, 0.4, 0.1) == pytest.approx(0.5**1.2 + 0.5**2, rel=1e-14)
    assert interaction(0.5, 0.4, 0.1, SHANK) == pytest.approx(0.5**2.5 + 0.5**1.5, rel=1e-14)
    assert slip_margin(0.2, 10e3, 1e3, 2e3) == pytest.approx(2000 / 1400 - 1, rel=1e-14)
    assert slip_margin(0.2, 10e3, 0.0) == np.inf


def lap(preload):
    joint = fy.preload(fy.lap_joint(element_size=5.0), {"bolt": preload})
    return joint, [fy.Load({"tip.Fz": 900.0, "tip.Fy": 100.0}, name="bend")]


THREAD = fy.Thread.named("M6", "8.8")
FACTORS = DesignFactors(fitting=1.1, ultimate=1.4, yields=1.25, separation=1.2, slip=1.3)
RANGE = PreloadRange(variation=0.2, loss=0.05)


@pytest.fixture(scope="module")
def margins():
    """Checks of a lap joint under factored loads, with its own solutions in their place."""
    joint, loads = lap(10e3)
    found = margin_checks(
        joint, contact_surfaces(joint), tangential_rows(joint), {"bolt": THREAD}, loads,
        {"bolt": 10e3}, {"bolt": RANGE}, FACTORS, {"joint": 0.15}, "mm-t-s",
    )  # fmt: skip
    return {one.quantity: one for one in found}


def solved(preload, factor):
    joint, loads = lap(preload)
    return fy.solve_static(joint, loads[0].scaled(factor))


TENSIONS = [("MS_u", 800, 1.4), ("MS_y", 640, 1.25)]


@pytest.mark.parametrize(("quantity", "stress", "factor"), TENSIONS)
def test_margins_of_tension_take_the_force_of_the_contact_model(margins, quantity, stress, factor):
    preload = 1.2 * 10e3
    tension = float(solved(preload, 1.1 * factor).bolt_force("bolt"))
    expected = contact_margin(stress * THREAD.stress_area, preload, tension)
    assert tension > preload
    # Tightened once by steps and once at once: 1e-10 of the force, of which a share is the gain.
    assert margins[quantity].value == pytest.approx(expected, rel=1e-5)
    assert (margins[quantity].scatter, margins[quantity].case) == ("P_p,max", "bend")


def test_separation_is_what_factored_loads_take_of_the_clamp_force(margins):
    preload = 0.95 * 0.8 * 10e3
    clamp = float(solved(preload, 1.1 * 1.2).contact_force("joint"))
    rest = float(solved(preload, 0.0).contact_force("joint"))
    assert margins["MS_sep"].utilisation == pytest.approx((rest - clamp) / rest, rel=1e-6)
    assert margins["MS_sep"].scatter == "P_p,min"


def test_slip_and_interaction_hold_their_equations(margins):
    joint, loads = lap(0.95 * 0.8 * 10e3)
    scaled = [loads[0].scaled(1.1 * 1.3)]
    wanted = fy.Requirements(slip_friction=0.15)
    found = fy.assess(joint, scaled, wanted, paths=False).interfaces["joint"]
    slip, clamp = found.slip, found.least_clamp
    shear = slip.needed_friction["bend"] * clamp
    expected = slip_margin(0.15, found.preload, shear, found.preload - clamp)
    assert margins["MS_slip"].value == pytest.approx(expected, rel=1e-6)
    assert margins["MS_slip"].part == "joint"
    solution = solved(1.2 * 10e3, 1.1 * 1.4)
    moment = np.linalg.norm(solution.bolt_bending("bolt"), axis=-1).max()
    tension = float(solution.bolt_force("bolt"))
    joint, loads = lap(1.2 * 10e3)
    along = fy.assess(joint, [loads[0].scaled(1.1 * 1.4)], paths=False).interfaces["joint"].slip
    sums = interaction(
        along.tangential_force["bend"] / (0.6 * 800 * THREAD.minor_area),
        tension / (800 * THREAD.stress_area),
        moment / THREAD.section_modulus / 800,
    )
    assert margins["ultimate, combined"].value == pytest.approx(sums, rel=1e-6)


def test_friction_changes_no_margin_of_strength(margins):
    # TFSR 13: at ultimate load it must not count
    joint = fy.lap_joint(element_size=5.0)
    rubbing = joint.with_interfaces(
        {
            name: one.with_law(Coulomb(one.law, 0.3, one.law.penalty))
            for name, one in joint.interfaces.items()
        }
    )
    rubbing = rubbing.with_bolt_forces(tighten(joint, {"bolt": 10e3}).initial_forces)
    _, loads = lap(10e3)
    found = margin_checks(
        rubbing, contact_surfaces(rubbing), tangential_rows(rubbing), {"bolt": THREAD}, loads,
        {"bolt": 10e3}, {"bolt": RANGE}, FACTORS, {"joint": 0.15}, "mm-t-s",
    )  # fmt: skip
    for one in found:
        # Margins are differences of forces that agree to 1e-10.
        assert one.value == pytest.approx(margins[one.quantity].value, rel=1e-6)


def test_margins_take_a_load():
    joint, _ = lap(10e3)
    with pytest.raises(ModelError, match="margins are of static load cases"):
        list(margin_checks(joint, {}, (), {}, [], {}, {}, FACTORS, {}, "mm-t-s"))


def test_safeties_of_vdi_lower_the_limits():
    joint, loads = lap(10e3)
    (check,) = (
        one
        for one in fy.assess(joint, loads, paths=False, threads={"bolt": THREAD}).checks
        if one.quantity == "yield"
    )
    (strict,) = with_safeties([check], Safeties(yields=2.0))
    assert strict.limit == pytest.approx(check.limit / 2, rel=1e-15)
    assert strict.utilisation == pytest.approx(2 * check.utilisation, rel=1e-15)
    assert strict.outcome == ("met" if 2 * check.utilisation <= 1 else "not met")
