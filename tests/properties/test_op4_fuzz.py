"""Damaged OP4 and DMIG files are refused or read as they stand: no traceback, no guess, no hang."""

import contextlib
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from damage import damaged
from hypothesis import given, settings
from hypothesis import strategies as st

from faying.exceptions import FormatError
from faying.io.dmig import dmig_text
from faying.io.matrix_tables import read_matrix
from faying.io.op4 import write_op4

MATRIX = np.array([[4.25, -1.5, 0.0, 2.0], [-1.5, 3.125, 0.0, 0.0], [0.0] * 4, [2.0, 0, 0, 1e-7]])


def number(value: float) -> str:
    return f"{value:23.16E}"


def dense_text() -> bytes:
    lines = ["       4       4       6       2K       1P,3E23.16"]
    for j, column in enumerate(MATRIX.T, start=1):
        rows = np.flatnonzero(column)
        if len(rows):
            values = column[rows[0] : rows[-1] + 1]
            lines.append(f"{j:8}{rows[0] + 1:8}{len(values):8}")
            lines += ["".join(map(number, values[i : i + 3])) for i in range(0, len(values), 3)]
    return ("\n".join([*lines, f"{5:8}{1:8}{1:8}", number(1.0)]) + "\n").encode()


def sparse_text(big: bool) -> bytes:
    rows = -4 if big else 4
    lines = [f"{4:8}{rows:8}{6:8}{2:8}K       1P,3E23.16"]
    for j, column in enumerate(MATRIX.T, start=1):
        entries = np.flatnonzero(column)
        if len(entries):
            lines.append(f"{j:8}{0:8}{len(entries) * (4 if big else 3):8}")
            for i in entries:
                lines.append(f"{3:8}{i + 1:8}" if big else f"{i + 1 + 65536 * 3:8}")
                lines.append(number(column[i]))
    return ("\n".join([*lines, f"{5:8}{1:8}{1:8}", number(1.0)]) + "\n").encode()


def binary(folder: Path) -> bytes:
    write_op4(folder / "k.op4", {"K": MATRIX})
    return (folder / "k.op4").read_bytes()


def dmig() -> bytes:
    dofs = np.array([(3, 1), (3, 2), (3, 3), (9, 0)])
    return dmig_text("K", MATRIX + np.diag([0, 0, 1.0, 0]), dofs).encode()


KINDS = ("binary", "dense", "nonbigmat", "bigmat", "dmig")


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, bytes]:
    return {
        "binary": binary(tmp_path_factory.mktemp("op4")),
        "dense": dense_text(),
        "nonbigmat": sparse_text(big=False),
        "bigmat": sparse_text(big=True),
        "dmig": dmig(),
    }


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("mutated")


def read(folder: Path, kind: str, content: bytes) -> np.ndarray:
    path = folder / f"k.{'dmig' if kind == 'dmig' else 'op4'}"
    path.write_bytes(content)
    return read_matrix(path, "K").matrix.toarray()


@pytest.mark.parametrize("kind", KINDS)
def test_sound_files(folder: Path, files: dict[str, bytes], kind: str) -> None:
    wanted = MATRIX + np.diag([0, 0, 1.0, 0]) if kind == "dmig" else MATRIX
    np.testing.assert_array_equal(read(folder, kind, files[kind]), wanted)


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS[:-1])
def test_cut_files_are_refused(folder: Path, files: dict[str, bytes], kind: str) -> None:
    content = files[kind]
    closing = 1 if kind == "binary" else 24  # the last value only ends the matrix
    for end in range(len(content) - closing):
        with pytest.raises(FormatError):
            read(folder, kind, content[:end])


@pytest.mark.long
@pytest.mark.parametrize("kind", KINDS[:-1])
def test_lost_characters_change_nothing_or_are_refused(
    folder: Path, files: dict[str, bytes], kind: str
) -> None:
    content = files[kind]
    for place in range(len(content)):
        with contextlib.suppress(FormatError):
            found = read(folder, kind, content[:place] + content[place + 1 :])
            np.testing.assert_array_equal(found, MATRIX)


def test_record_lengths_are_checked(folder: Path, files: dict[str, bytes]) -> None:
    content, place, markers = files["binary"], 0, []
    while place < len(content):
        length = int.from_bytes(content[place : place + 4], "little")
        markers += [place, place + 4 + length]
        place += 8 + length
    assert len(markers) == 10
    for marker in markers:
        for change in (1, 4, 8, 128):
            changed = bytearray(content)
            changed[marker] ^= change
            with pytest.raises(FormatError, match=r"byte|binary"):
                read(folder, "binary", bytes(changed))


@pytest.mark.parametrize("kind", ["dense", "nonbigmat", "bigmat"])
def test_a_changed_digit_is_read_as_it_stands(
    folder: Path, files: dict[str, bytes], kind: str
) -> None:
    lines = files[kind].splitlines(keepends=True)
    changed = 0
    for i in range(2, len(lines) - 2):
        if b"." not in lines[i]:
            continue
        for place in (1, 5, 18, 22):
            line = lines[i][:place] + b"7" + lines[i][place + 1 :]
            text = b"".join([*lines[:i], line, *lines[i + 1 :]])
            with contextlib.suppress(FormatError):
                found = read(folder, kind, text)
                different = found != MATRIX
                assert different.sum() <= 1
                assert (found[different] == float(line[:23])).all()
                changed += int(different.sum())
    assert changed > 10


@pytest.mark.long
@settings(max_examples=300)
@given(kind=st.sampled_from(KINDS), data=st.data())
def test_any_damage(folder: Path, files: dict[str, bytes], kind: str, data: st.DataObject) -> None:
    content = data.draw(damaged(files[kind], text=kind != "binary")) or b"x"
    tracemalloc.start()
    try:
        with contextlib.suppress(FormatError):
            found = read_mutated(folder, kind, content)
            assert np.isfinite(found).all()
        # A million rows, the most a small file may claim, take 8 MB for their pointers, and the
        # same for their copies.
        assert tracemalloc.get_traced_memory()[1] < 100e6
    finally:
        tracemalloc.stop()


def read_mutated(folder: Path, kind: str, content: bytes) -> np.ndarray:
    path = folder / f"m.{'dmig' if kind == 'dmig' else 'op4'}"
    path.write_bytes(content)
    return read_matrix(path, "K").matrix.data


@pytest.mark.long
@settings(max_examples=100)
@given(st.binary(max_size=200), st.sampled_from(["op4", "dmig"]))
def test_noise(folder: Path, content: bytes, suffix: str) -> None:
    path = folder / f"noise.{suffix}"
    for start in (b"", b"\x18\0\0\0", b"\0\0\0\x30", b"DMIG*   K"):
        path.write_bytes(start + content)
        with pytest.raises(FormatError):
            read_matrix(path, "K")
