"""write → read is the identity; foreign and damaged files end in one message."""

from dataclasses import MISSING, fields, is_dataclass, replace
from hashlib import sha256
from pathlib import Path
from types import NoneType
from typing import get_args, get_type_hints

import h5py
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from fake_results import fake_results
from faying.exceptions import FormatError
from faying.study.results import store
from faying.study.results.store import MEANINGS, read_results, write_results

RESULTS = fake_results()


def assert_same(found, expected):
    """Exact equality: the file keeps float64 to the last bit."""
    if is_dataclass(expected):
        assert type(found) is type(expected)
        for field in fields(expected):
            assert_same(getattr(found, field.name), getattr(expected, field.name))
    elif isinstance(expected, dict):
        assert list(found) == list(expected)
        for key, value in expected.items():
            assert_same(found[key], value)
    elif isinstance(expected, tuple):
        assert isinstance(found, tuple)
        assert len(found) == len(expected)
        for one, other in zip(found, expected, strict=True):
            assert_same(one, other)
    elif isinstance(expected, np.ndarray):
        assert isinstance(found, np.ndarray)
        assert found.dtype == expected.dtype
        np.testing.assert_array_equal(found, expected, strict=True)
    else:
        assert type(found) is type(expected)
        assert found == expected


def test_reading_returns_what_was_written(tmp_path):
    write_results(RESULTS, tmp_path / "results.h5")
    assert_same(read_results(tmp_path / "results.h5"), RESULTS)


texts = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=20)
names = texts.filter(bool)
numbers = st.floats(allow_nan=False)


POINTS = RESULTS.cases["LC1"].reference.pressure.shape


# The folder is shared by all examples; each replaces the file. What is read must fit together, so
# arrays of one record have one length: pressures that of the contact points, tried numbers of joint
# modes any.
@pytest.mark.long
@settings(max_examples=40)
@given(
    pressure=arrays(float, POINTS, elements=st.floats(allow_nan=False, allow_infinity=False)),
    bounds=arrays(float, st.integers(0, 100), elements=numbers),
    timings=st.dictionaries(names, numbers),
    words=st.dictionaries(names, texts, max_size=5),
    lines=st.lists(texts, max_size=4).map(tuple),
    number=numbers,
)
def test_reading_returns_anything_that_was_written(
    tmp_path, pressure, bounds, timings, words, lines, number
):
    whole = RESULTS.cases["LC1"]
    moved = whole.reference.displacements["tip"]
    response = replace(
        whole.reference,
        pressure=pressure,
        displacements=dict.fromkeys(words, moved),
        nodal_displacement=None,
    )
    components = dict.fromkeys(words, whole.components["tip"])
    case = replace(whole, reference=response, components=components, methods={})
    tried = np.arange(len(bounds))
    choice = replace(RESULTS.validation.choices["jim-b"], counts=tried, bounds=bounds)
    bolt = replace(RESULTS.bolts["bolt"], history=np.arange(len(lines), dtype=float))
    results = replace(
        RESULTS,
        mass=number,
        timings=timings,
        provenance=words,
        warnings=lines,
        tightening_stages=lines,
        bolts={"bolt": bolt},
        blocks=(),
        cases=dict.fromkeys(words, case),
        validation=replace(RESULTS.validation, choices=dict.fromkeys(words, choice)),
    )
    write_results(results, tmp_path / "results.h5")
    assert_same(read_results(tmp_path / "results.h5"), results)


@pytest.mark.long
def test_any_name_comes_back(tmp_path):
    # HDF5 splits at slashes and reads a dot as the group itself.
    names = dict.fromkeys(("a/b", "a%2Fb", ".", "..", "50 %", "%2E", "λ, ß"), "text")
    write_results(replace(RESULTS, provenance=names), tmp_path / "results.h5")
    assert_same(read_results(tmp_path / "results.h5").provenance, names)


def test_every_field_has_a_meaning():
    for kind, meanings in MEANINGS.items():
        assert set(meanings) == {field.name for field in fields(kind)}, kind


def test_file_explains_itself_without_faying(tmp_path):
    write_results(RESULTS, tmp_path / "results.h5")
    with h5py.File(tmp_path / "results.h5") as file:
        assert file.attrs["unit_of_pressure"] == "MPa"
        pressure = file["cases/LC2-step/methods/jim-b/20/response/pressure"]
        assert pressure.attrs["unit"] == "MPa"
        assert pressure.attrs["dimension"] == "force/length²"
        assert pressure.attrs["shape"] == "([n_time,] n_point)"
        assert pressure.dtype == np.float64
        assert file["interfaces/joint/penalty"].attrs["unit"] == "N/mm³"
        assert file["study_text"].asstr()[()] == RESULTS.study_text
        assert list(file["cases/LC1/methods/jim-a"]) == ["5", "20"]
        members = []
        file.visit(members.append)
        assert all(file[name].attrs["description"] for name in members)


def test_interrupted_writing_leaves_the_old_file(tmp_path, monkeypatch):
    path = tmp_path / "results.h5"
    write_results(RESULTS, path)
    before = path.read_bytes()

    def fail(*arguments):
        message = "disk full"
        raise OSError(message)

    monkeypatch.setattr(store, "write_members", fail)
    with pytest.raises(FormatError, match=r"cannot write .*results\.h5: disk full; check the"):
        write_results(RESULTS, path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def of_another_program(path):
    with h5py.File(path, "w") as file:
        file["pressure"] = 1.0


def of_another_version(path):
    with h5py.File(path, "r+") as file:
        file.attrs["format_version"] = 99


def without_an_entry(path):
    with h5py.File(path, "r+") as file:
        del file["cases/LC1/reference/gap"]


def with_a_flipped_bit(path):
    with h5py.File(path) as file:
        chunk = file["cases/LC2-step/reference/pressure"].id.get_chunk_info(0)
    content = bytearray(path.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 1
    path.write_bytes(content)


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (Path.unlink, "does not exist"),
        (lambda path: path.write_text("hello"), "is not an HDF5 file"),
        (of_another_program, "but holds no faying"),
        (of_another_version, r"format 99.*reads 4; run the study again"),
        (without_an_entry, "/cases/LC1/reference/gap is missing"),
        (lambda path: path.write_bytes(path.read_bytes()[:-5000]), r"cut off|damaged"),
        (with_a_flipped_bit, "damaged"),
    ],
)
def test_files_that_hold_no_whole_results_are_refused(tmp_path, change, message):
    path = tmp_path / "results.h5"
    write_results(RESULTS, path)
    change(path)
    with pytest.raises(FormatError, match=message):
        read_results(path)


@pytest.mark.long
def test_entry_with_a_default_may_be_missing(tmp_path):
    write_results(RESULTS, tmp_path / "results.h5")
    with h5py.File(tmp_path / "results.h5", "r+") as file:
        del file["validation"], file["warnings"]
    found = read_results(tmp_path / "results.h5")
    assert found.warnings == ()
    assert found.validation.load_space is None
    assert RESULTS.validation.load_space is not None


REQUIRED = {4: "bb8edb9e464901ca"}
"""Format of results: digest of what they must hold. A new entry without a default raises it;
one that goes does not, for files that have it are read.

Checks, measured curves and harmonic loads are lists of their own, which files of the same format
may lack.
"""


def test_entries_that_must_be_there_are_those_of_the_format():
    required = [
        f"{kind.__name__}.{field.name}"
        for kind in sorted(MEANINGS, key=lambda one: one.__name__)
        for field in fields(kind)
        if field.name in MEANINGS[kind]
        and field.default is field.default_factory is MISSING
        and NoneType not in get_args(get_type_hints(kind)[field.name])
    ]
    assert sha256("\n".join(required).encode()).hexdigest()[:16] == REQUIRED[store.RESULTS.version]
