"""Mutated decks with every card: an answer or one message, and no number read as another."""

import contextlib
import random
import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from nastran_decks import BULK, CONTROL, HEAVY, SUBCASES

from clamped_plates import nastran_deck
from faying.exceptions import FayingError, FormatError
from faying.io.nastran import read_joint

fuzzed = settings(max_examples=80)
JUNK = (
    *(b"", b"X", b"1", b"-1", b"0", b".", b"1.E300", b",", b",,", b"\t", b"\xff", b"\0", b"O"),
    *(b"*", b"THRU", b"BY", b"EXCEPT", b"$", b"'", b"99999999", b"9" * 20, b"1.-400", b"=", b"-"),
    *(b"SUBCASE 1", b"CEND", b"BEGIN BULK", b"ENDDATA", b"\nINCLUDE 'b'"),
)
BOLTED = [nastran_deck(bolt) for bolt in ("etype 2", "etype 3", "split")]


def test_the_unbroken_deck_reads(tmp_path: Path) -> None:
    path = tmp_path / "a.bdf"
    path.write_text(CONTROL + BULK)
    joints = [read_joint(path, subcase=number) for number in SUBCASES]
    assert [[spec.name for spec in joint.interfaces] for joint in joints] == [
        ["contact-5-6"],
        ["contact-7-8"],
        ["contact-7-8"],
        [],
    ]
    assert [joint.preloads for joint in joints] == [{"bolt-1": 10000.0}, {}, {}, {}]


@pytest.mark.long
@fuzzed
@given(seed=st.integers(0, 2**32 - 1))
def test_mutated_decks_raise_only_faying_errors(tmp_path: Path, seed: int) -> None:
    rng = random.Random(seed)
    lines = rng.choice((CONTROL + BULK, HEAVY, *BOLTED)).encode().split(b"\n")
    for _ in range(rng.randint(1, 4)):
        i = rng.randrange(len(lines))
        line = lines[i]
        at, junk = rng.randrange(len(line) + 1), rng.choice(JUNK)
        fields = line.split(b",")
        fields[rng.randrange(len(fields))] = junk
        lines[i] = rng.choice(
            [
                line[:at] + junk + line[at + rng.randrange(4) :],
                b",".join(fields),
                line + b"\n" + line,
                b"",
                rng.choice(lines),
            ]
        )
    path = tmp_path / "a.bdf"
    path.write_bytes(b"\n".join(lines))
    with contextlib.suppress(FayingError):
        read_joint(path, subcase=rng.choice([None, *SUBCASES]))


# Not numbers that enter a joint of solids: damping and stress recovery of a spring.
UNREAD = {("PELAS", 0, 3), ("PELAS", 0, 4)}
NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([ED]?[+-]?\d+)?")


def numeric_fields() -> list[tuple[int, int]]:
    """Line and field of every number of the deck."""
    found, name, row = [], "", 0
    for i, line in enumerate(BULK.splitlines()):
        fields = line.split(",")
        name, row = (fields[0], 0) if fields[0] else (name, row + 1)
        found += [
            (i, k)
            for k, text in enumerate(fields)
            if k and NUMBER.fullmatch(text) and (name, row, k) not in UNREAD
        ]
    return found


SLIPS = ("1O", "1.0-", "1.2.3", "1 2", "--1", "0x1", "1.E", "NAN", "1_0", "l.")


@pytest.mark.long
@pytest.mark.parametrize("bad", SLIPS)
def test_no_malformed_number_is_read_as_another(tmp_path: Path, bad: str) -> None:
    """Each number of the deck in turn, by one kind of slip."""
    lines, places = BULK.splitlines(), numeric_fields()
    assert len(places) > 350
    path = tmp_path / "a.bdf"
    for i, k in places[SLIPS.index(bad) :: len(SLIPS)]:
        fields = lines[i].split(",")
        fields[k] = bad
        path.write_text(CONTROL + "\n".join([*lines[:i], ",".join(fields), *lines[i + 1 :]]))
        assert any(refused(path, number) for number in SUBCASES), (lines[i], k)


@pytest.mark.long
@pytest.mark.parametrize("bad", SLIPS)
def test_no_malformed_number_is_read_as_another_with_all_elements(tmp_path: Path, bad: str) -> None:
    lines = HEAVY.splitlines()
    path = tmp_path / "a.bdf"
    path.write_text(HEAVY)
    assert list(read_joint(path).assembly.loads) == ["spc", "1", "2", "10"]
    for i, line in enumerate(lines):
        if line.startswith(("GRAV", "RFORCE", "SPC")):
            for k in range(1, len(line.split(","))):
                fields = line.split(",")
                fields[k] = bad
                text = "\n".join([*lines[:i], ",".join(fields), *lines[i + 1 :]])
                path.write_text(text)
                # METHOD of RFORCE says how lumped masses are treated.
                if not (line.startswith("RFORCE") and k == 8):
                    with pytest.raises(FormatError):
                        read_joint(path)


def refused(path: Path, subcase: int) -> bool:
    try:
        read_joint(path, subcase=subcase)
    except FormatError:
        return True
    return False


def plain(text: str) -> float | None:
    """Nastran's real by another way than the reader's; None if it is none."""
    text = text.strip()
    if not text:
        return 0.0
    match = re.fullmatch(r"([+-]?[0-9]*\.?[0-9]*)(?:[EDed]?([+-]?[0-9]+))?", text)
    if not match or not any(c.isdigit() for c in match[1]):
        return None
    if match[2] and match[2].isdigit() and not re.search("[EDed]", text):
        return None if "." not in match[1] else float(text)
    return float(match[1] + "E" + (match[2] or "0"))


@pytest.mark.long
@fuzzed
@given(
    place=st.integers(24, 47),
    character=st.sampled_from("0123456789.-+ EDOI,$"),
    shift=st.booleans(),
)
def test_a_changed_coordinate_is_read_as_changed_or_refused(
    tmp_path: Path, place: int, character: str, shift: bool
) -> None:
    """Overwrite or insert a character in the coordinates of a GRID in small fields."""
    line = "GRID           1        12.34567-1.2345+.0123-3"
    line = line[:23] + " " + line[24:]
    assert len(line) == 47
    changed = line[:place] + character + line[place + (0 if shift else 1) :]
    path = tmp_path / "a.bdf"
    path.write_text(changed + "\n")
    text = changed.partition("$")[0]
    free = "," in text
    expected = [None if free else plain(text[at : at + 8]) for at in (24, 32, 40)]
    if text[48:].strip():
        expected = [None]
    try:
        nodes = read_joint(path).assembly.mesh.nodes
    except FormatError:
        return
    assert None not in expected, changed
    np.testing.assert_array_equal(nodes[0], np.array(expected, dtype=float))


def test_digits_beyond_the_data_columns_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.bdf"
    line = "CORD2R         4       0      0.      0.      0.      1.      0."
    below = "+             0.      1.      0."
    path.write_text(f"GRID,1\n{line}     .25\n{below}\n")
    assert read_joint(path).assembly.mesh.nodes.shape == (1, 3)
    path.write_text(f"GRID,1\n{line}      .25\n{below}\n")
    with pytest.raises(FormatError, match=r"2: '\.25' runs over column 72"):
        read_joint(path)
    # The same characters are a mark where the continuation repeats them.
    path.write_text(f"GRID,1\n{line}      .27\n+7{below[2:]}\n")
    assert read_joint(path).assembly.mesh.nodes.shape == (1, 3)


def rewritten(line: str, form: str, rng: random.Random) -> str:
    """A free-field line in small, large or free field, aligned and marked at random."""
    name, *fields = line.split(",")
    fields += [""] * (8 - len(fields))
    if form == "free":
        return line
    wide = 16 if form == "large" else 8
    texts = ["".join(rng.choice((text.ljust, text.rjust))(wide)) for text in fields]
    head = name or rng.choice(["", "+"])
    if form == "small":
        return (head.ljust(8) + "".join(texts)).rstrip() or "+"
    first = (f"{name}*" if name else "*").ljust(8) + "".join(texts[:4])
    return f"{first}\n{'*'.ljust(8)}{''.join(texts[4:])}".rstrip()


def same(one, other) -> bool:
    """Whether two values are equal, field by field."""
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other)
    if hasattr(one, "__dataclass_fields__"):
        return all(same(getattr(one, key), getattr(other, key)) for key in vars(one))
    if isinstance(one, Mapping):
        return list(one) == list(other) and all(same(one[key], other[key]) for key in one)
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other)


@pytest.mark.long
@fuzzed
@given(seed=st.integers(0, 2**32 - 1), subcase=st.sampled_from(SUBCASES))
def test_the_form_of_the_fields_does_not_matter(tmp_path: Path, seed: int, subcase: int) -> None:
    rng = random.Random(seed)
    path, lines = tmp_path / "a.bdf", []
    for line in BULK.splitlines():
        lines.append(rewritten(line, rng.choice(["free", "small", "large"]), rng))
        if rng.random() < 0.1:
            lines.append(rng.choice(["$ a comment", "", "$"]))
    (tmp_path / "part.inc").write_text("\n".join(lines[90:]))
    # The rest of the deck, and part of case control, come from other files.
    control = CONTROL.replace("BEGIN BULK\n", "")
    (tmp_path / "control.inc").write_text(control[control.index("SUBCASE 1") :])
    head = control[: control.index("SUBCASE 1")] + "INCLUDE 'control.inc'\nBEGIN BULK\n"
    path.write_text(head + "\n".join(lines[:90]) + "\nINCLUDE part.inc\nENDDATA\n")
    found = read_joint(path, subcase=subcase)
    path.write_text(CONTROL + BULK)
    assert same(found, read_joint(path, subcase=subcase))
