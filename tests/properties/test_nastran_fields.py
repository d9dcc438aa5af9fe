"""Numbers survive any field form; broken decks raise FayingError and nothing else."""

import contextlib
import math
import random

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from faying.exceptions import FayingError
from faying.io.nastran import read_deck, write_deck
from faying.io.nastran.fields import format_real, integer, integers, real, reals
from faying.joint.lap_joint import lap_joint_assembly

# Beyond 1e300 a shortened mantissa may round up to infinity.
FLOATS = st.floats(min_value=-1e300, max_value=1e300)


@given(FLOATS, st.sampled_from([8, 16]))
def test_formatted_reals_read_back(value: float, width: int) -> None:
    text = format_real(value, width)
    assert len(text) <= width
    back = real(text)
    assert back is not None
    # Sign, point and a three-digit exponent with its sign leave at least 2 and 10 digits; the
    # rounding error is half a unit of the last one. Denormals have fewer digits of their own.
    assert math.isclose(back, value, rel_tol=0.051 if width == 8 else 5.1e-10, abs_tol=1e-322)


@given(st.floats(min_value=1e-9, max_value=1e9), st.booleans())
def test_usual_magnitudes_keep_ten_digits(value: float, negative: bool) -> None:
    value = -value if negative else value
    assert real(format_real(value)) == pytest.approx(value, rel=1e-11, abs=0)


@given(FLOATS)
def test_python_reals_in_any_notation(value: float) -> None:
    shown = repr(value).upper()
    for text in (shown, shown.replace("E", "D"), shown.replace("E", "")):
        if "E" in shown and ("+" not in shown.split("E")[1] and "-" not in shown.split("E")[1]):
            continue
        assert real(text) == value


@given(st.lists(st.text(alphabet="0123456789+-.DE ", max_size=16), min_size=1, max_size=20))
def test_batch_and_single_parsers_agree(texts: list[str]) -> None:
    for width in (8, 16):
        cut = [text[:width] for text in texts]
        raw = np.array([text.encode() for text in cut], dtype=f"S{width}")
        for batch, single in ((reals, real), (integers, integer)):
            values, bad = batch(raw)
            wanted = [single(text.strip()) if text.strip() else None for text in cut]
            assert bad.tolist() == [value is None for value in wanted]
            assert values.tolist() == [value or 0 for value in wanted]


@pytest.fixture(scope="module")
def deck(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("fuzz") / "a.bdf"
    joint = lap_joint_assembly(element_size=10.0, washer_radius=9.0, washer="rbe3")
    write_deck(joint.assembly, path)
    more = (
        b"CORD2C,2,,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,9001,2,2.,30.,0.,2\nGRID,9002,,0.,1.,1.,2\n"
        b"MPC,3,9001,1,1.,1,1,-1.\nSPC1,4,12,9001\nSPC,5,1,1,0.\nSPCADD,6,4,5\nCORD1R,7,1,2,9\n"
        b"CBAR,9003,50,9001,9002,1.,0.,.5\nPBARL,50,1,,BOX\n,4.,4.,1.,1.\nRBE2,9004,9002,123,5\n"
        b"FORCE,1,9001,2,1.,1.,2.,3.\nLOAD,9,2.,1.,1\nCELAS2,9006,5.,9002,3\nCONM2,9007,1,,2.\n"
        b"CBEAM,9009,51,9001,9002,9\nPBEAML,51,1,,TUBE\n,2.,1.\nSET1,3,1,THRU,5\nGRDSET,,,,,,,456\n"
        b"PARAM,WTMASS,2.\nMPC,3,2,1,1.,3,1,2.\n,,4,1,.5\nENDDATA\n"
    )
    text = path.read_bytes().replace(b"ENDDATA\n", more)
    return text.replace(b"BEGIN BULK", b"MPC = 3\nBEGIN BULK")


def test_the_unbroken_deck_reads(deck: bytes, tmp_path) -> None:
    (tmp_path / "a.bdf").write_bytes(deck)
    assert len(read_deck(tmp_path / "a.bdf").equations) == 2


@pytest.mark.long
@settings(
    max_examples=150, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(seed=st.integers(0, 2**32 - 1))
def test_mutated_decks_raise_only_faying_errors(deck: bytes, tmp_path, seed: int) -> None:
    rng = random.Random(seed)
    lines = deck.split(b"\n")
    # Most of the deck is GRID and CHEXA; half of the mutations go to the rest.
    rare = [i for i, x in enumerate(lines) if x[:4] not in (b"GRID", b"CHEX", b"*   ", b"+   ")]
    for _ in range(rng.randint(1, 4)):
        i = rng.choice(rare) if rng.random() < 0.5 else rng.randrange(len(lines))
        lines[i] = _mutated(lines[i], rng)
    path = tmp_path / "a.bdf"
    path.write_bytes(b"\n".join(lines))
    with contextlib.suppress(FayingError):
        read_deck(path)


def _mutated(line: bytes, rng: random.Random) -> bytes:
    at = rng.randrange(len(line) + 1)
    junk = rng.choice(
        [
            *(b"", b"X", b"1", b"-1", b"0", b".", b"1.E300", b",", b",,", b"\t", b"\xff", b"\0"),
            *(b"*", b"THRU", b"$", b"'", b"99999999", b"9" * 20, b"1.-400", b"ENDDATA"),
            b"\nINCLUDE 'b'",
        ]
    )
    kind = rng.randrange(4)
    if kind == 0:
        return line[:at] + junk + line[at + rng.randrange(9) :]
    if kind == 1:
        parts = line.split(b",") if b"," in line else [line[i : i + 8] for i in range(0, 72, 8)]
        parts[rng.randrange(len(parts))] = junk if b"," in line else junk[:8].ljust(8)
        return (b"," if b"," in line else b"").join(parts)
    return line + b"\n" + line if kind == 2 else b""
