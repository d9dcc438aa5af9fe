"""Damaged input decks: an error that names the place, or what the deck now says."""

import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FormatError, ModelError
from faying.io.abaqus import read_joint
from small_abaqus_deck import DECK, LOOSE, PARTS, SHANK, TIED, TURNED, WOOD

# Reading takes a few milliseconds; the file is written anew for every example.
QUICK = settings(max_examples=150)
ALPHABET = "0123456789+-.,*=EeDd \nABCSTNO\"'\t_\0é"


def read(path, text):
    file = path / "deck.inp"
    file.write_bytes(text.encode("utf-8"))
    return read_joint(file)


def attempt(path, text):
    """What the deck says and an empty message, or None and the message of the refusal."""
    try:
        return read(path, text), ""
    except (FormatError, ModelError) as error:
        return None, str(error)


def finite(described):
    return np.isfinite(described.assembly.mesh.nodes).all()


@st.composite
def damaged(draw):
    """A deck with a few characters or lines deleted, doubled, changed or cut off."""
    text = draw(st.sampled_from((DECK, LOOSE, PARTS, SHANK, TIED, TURNED, WOOD)))
    for _ in range(draw(st.integers(1, 3))):
        kind = draw(
            st.sampled_from(("delete", "insert", "change", "drop", "double", "cut", "swap"))
        )
        lines = text.splitlines(keepends=True)
        if not lines:
            break
        at, row = draw(st.integers(0, len(text) - 1)), draw(st.integers(0, len(lines) - 1))
        other = draw(st.integers(0, len(lines) - 1))
        letter = draw(st.sampled_from(ALPHABET))
        if kind == "delete":
            text = text[:at] + text[at + 1 :]
        elif kind == "insert":
            text = text[:at] + letter + text[at:]
        elif kind == "change":
            text = text[:at] + letter + text[at + 1 :]
        elif kind == "drop":
            text = "".join(lines[:row] + lines[row + 1 :])
        elif kind == "double":
            text = "".join([*lines[:row], lines[row], *lines[row:]])
        elif kind == "swap":
            lines[row], lines[other] = lines[other], lines[row]
            text = "".join(lines)
        else:
            text = text[:at]
    return text


@pytest.mark.long
@given(text=damaged())
@QUICK
def test_damage_is_refused_with_its_place_or_read(tmp_path, text):
    described, message = attempt(tmp_path, text)
    # Most messages name a line; what concerns the whole deck names the file.
    assert "deck.inp" in message if described is None else finite(described)


NUMBER = re.compile(r"(?<![\w.])-?\d+\.(?:\d+)?(?:[EeDd][+-]?\d+)?(?![\w.])")


def numbers_of(described):
    """Every real number an assembly and its interfaces, bolts and loads carry."""
    assembly = described.assembly
    found = [assembly.mesh.nodes.ravel()]
    found += [
        [material.youngs_modulus, material.poissons_ratio, material.density]
        for material in assembly.materials.values()
    ]
    for beam in assembly.beams:
        section = beam.section
        found.append([section.area, section.inertia_y, *beam.orientation])
        found.append([beam.material.youngs_modulus, beam.material.poissons_ratio])
        found.append([beam.material.density])
    found.append([spring.stiffness for spring in assembly.springs])
    found.append([mass.mass for mass in assembly.masses])
    found += [[t[2] for t in equation.terms] for equation in assembly.equations]
    found += [load.forces.ravel() for load in assembly.loads.values()]
    found.append([interface.penalty for interface in described.interfaces])
    found.append(list(described.preloads.values()))
    return np.concatenate([np.asarray(part, dtype=float).ravel() for part in found])


PLACES = [m for m in NUMBER.finditer(DECK) if "1., 1.\n*CLOAD" not in DECK[m.start() :][:14]]
# The times of the step have no place in a model.
PLACES = [m for m in PLACES if not DECK[: m.start()].endswith(("*STATIC\n", "*STATIC\n1., "))]


@pytest.fixture(scope="module")
def intact(tmp_path_factory):
    return numbers_of(read(tmp_path_factory.mktemp("intact"), DECK))


@pytest.mark.long
@given(place=st.sampled_from(PLACES), factor=st.floats(0.3, 3.0))
@QUICK
def test_a_changed_number_is_read_as_changed_or_refused(tmp_path, intact, place, factor):
    old = float(place.group().upper().replace("D", "E"))
    new = old * factor if old else factor
    if new == old:
        return
    text = DECK[: place.start()] + repr(new) + DECK[place.end() :]
    described, message = attempt(tmp_path, text)
    if described is None:
        assert "deck.inp" in message
        return
    found = numbers_of(described)
    assert found.shape != intact.shape or (found != intact).any()


@pytest.mark.long
@given(place=st.sampled_from(PLACES), position=st.integers(0, 8), letter=st.sampled_from("OlIx_;:"))
@QUICK
def test_letters_inside_numbers_are_refused(tmp_path, place, position, letter):
    at = min(place.start() + position, place.end() - 1)
    text = DECK[:at] + letter + DECK[at + 1 :]
    with pytest.raises((FormatError, ModelError), match=r"deck\.inp"):
        read(tmp_path, text)
