"""Contact of everything in Abaqus decks: the pairs of bodies that face each other."""

from dataclasses import replace

import pytest

import faying as fy
from clamped_plates import PAIRS, abaqus_deck
from faying.exceptions import FormatError
from faying.interface.facing import facing_bodies
from faying.io.abaqus import general_contact, read_joint
from faying.model.specs import GapRule

EVERYTHING = ("*Contact", "*Contact Inclusions, ALL EXTERIOR")
ASSIGNED = ("*Contact Property Assignment", " ,  , IntProp-1")


def read(folder, *contact):
    path = folder / "plates.inp"
    path.write_text(abaqus_deck(contact))
    return read_joint(path)


def areas(described):
    """Contact areas by the heights of the lowest and the highest point, to six digits."""
    model = fy.build_model(
        described.assembly, interfaces=described.interfaces, bolts=described.bolts
    )
    found = {}
    for one in model.interfaces.values():
        heights = one.points[:, 2]
        place = (round(float(heights.min()), 6), round(float(heights.max()), 6))
        found[place] = round(float(one.weights.sum()), 6)
    return found


def test_the_bodies_that_touch_are_the_pairs(tmp_path):
    """The sides of the cut through the bolt touch too, and are none."""
    described = read(tmp_path, *EVERYTHING, *ASSIGNED)
    assert areas(described) == areas(read(tmp_path, *PAIRS))
    assert {(one.penalty, one.friction) for one in described.interfaces} == {("hard", 0.0)}
    assert any(
        "general contact: an interface for each pair" in n for n in described.assembly.ignored
    )


def test_what_is_tied_or_paired_already_is_left_out(tmp_path):
    tied = ("*Tie, name=T", "Seat, Head", *EVERYTHING, *ASSIGNED)
    assert [*areas(read(tmp_path, *tied))] == [(0.0, 0.0), (10.0, 10.0)]
    both = read(tmp_path, PAIRS[0], *EVERYTHING, *ASSIGNED)
    assert len(both.interfaces) == 3


def test_bodies_that_share_no_area_have_no_interface(tmp_path, monkeypatch):
    """As a shank beside the far edge of a hole, which slivers of curved facets seem to face."""

    def with_a_sliver(assembly):
        found = facing_bodies(assembly)
        far = replace(found[0], minus=0, plus=3, touching=True, matching=False)
        return [*found, far]

    monkeypatch.setattr(general_contact, "facing_bodies", with_a_sliver)
    described = read(tmp_path, *EVERYTHING, *ASSIGNED)
    assert areas(described) == areas(read(tmp_path, *PAIRS))
    (note,) = [n for n in described.assembly.ignored if "close to each other" in n]
    assert "is empty" in note


LISTED = ("*Contact", "*Contact Inclusions", "Under, Over", "Seat, Head", "Bottom, Nut")


def test_listed_surfaces_are_pairs(tmp_path):
    """The property of two of them overrides that of all; what is solution control stays out."""
    control = ("*Contact Formulation, type=MASTER SLAVE ROLES", "Seat, Head, SLAVE")
    described = read(
        tmp_path, *LISTED, *ASSIGNED, "Head, Seat, Soft", *control, "*Contact Stabilization",
        "*Surface Interaction, name=Soft", "*Surface Behavior, pressure-overclosure=LINEAR", "1.e4",
    )  # fmt: skip
    assert areas(described) == areas(read(tmp_path, *PAIRS))
    assert [one.penalty for one in described.interfaces] == ["hard", 1e4, "hard"]
    assert [one.minus for one in described.interfaces] == ["Under", "Seat", "Bottom"]
    assert {spec.gap for spec in described.interfaces} == {GapRule(closed_up_to=0.0)}
    notes = described.assembly.ignored
    assert any("general contact of listed surfaces" in note for note in notes)
    assert any(note.startswith("1 *CONTACT FORMULATION: roles") for note in notes)


REFUSED = [
    (EVERYTHING, "CONTACT INCLUSIONS: it needs"),
    ((*EVERYTHING, "Seat, Head", *ASSIGNED), "list surfaces without it"),
    ((*LISTED, "Seat,", *ASSIGNED), "expected the slave and the master surface"),
    (LISTED, "gives this pair no"),
    ((*LISTED, *ASSIGNED, "Seat, , IntProp-1"), "found 'Seat, , IntProp-1', expected two"),
    ((*LISTED, *ASSIGNED, "Seat, Nut, IntProp-1"), "surfaces Nut and Seat have a property, but"),
    ((*EVERYTHING, ASSIGNED[0], "Seat, Head, IntProp-1"), "one .* for all pairs; define"),
    ((*EVERYTHING, *ASSIGNED, *ASSIGNED), "found ', , IntProp-1', expected two"),
    ((*EVERYTHING, ASSIGNED[0], " , , Other"), "found ', , Other', expected two"),
    ((*EVERYTHING, "*Contact Exclusions", "Seat, Head", *ASSIGNED), "CONTACT EXCLUSIONS"),
]


@pytest.mark.parametrize(("lines", "message"), REFUSED)
def test_contact_of_some_surfaces_is_refused(tmp_path, lines, message):
    with pytest.raises(FormatError, match=message):
        read(tmp_path, *lines)
