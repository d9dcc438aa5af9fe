"""Rows of csv files, whatever stands in them."""

import pytest

import faying as fy
from faying.exceptions import FormatError
from faying.files.csv_rows import csv_rows
from faying.interface.gap_field import read_gap_table
from faying.study.keys.load_files import read_load_factors
from faying.study.stages.imported_history import read_imported_history

ENDLESS = "n" * 200_000
"""More than a cell may have; longer by far than any number or name."""


def test_rows_are_numbered(tmp_path):
    rows = csv_rows(tmp_path / "some.csv", ["a,b", "", '"1,0",2'], first=4)
    assert list(rows) == [(4, ["a", "b"]), (5, []), (6, ["1,0", "2"])]


@pytest.mark.parametrize("line", [f'"{ENDLESS},1', f'{ENDLESS},1,"'])
def test_a_cell_without_end_is_refused_with_its_line(tmp_path, line):
    rows = csv_rows(tmp_path / "some.csv", ["a,b", line])
    assert next(rows) == (1, ["a", "b"])
    with pytest.raises(FormatError, match=r"some\.csv, line 2: field larger .*; close quotes"):
        next(rows)


@pytest.mark.parametrize(
    "read",
    [
        read_gap_table,
        lambda path: read_load_factors(path, ["tip.Fz"]),
        lambda path: read_imported_history(path, fy.lap_joint(element_size=10.0)),
    ],
    ids=["gaps", "factors", "history"],
)
def test_readers_refuse_it(tmp_path, read):
    path = tmp_path / "some.csv"
    path.write_text(f'"{ENDLESS}\n1\n')
    with pytest.raises(FormatError, match="line 1: field larger than field limit"):
        read(path)


def test_factors_beyond_all_bounds(tmp_path):
    path = tmp_path / "way.csv"
    path.write_text("factor\n1\n1e308\n")
    with pytest.raises(FormatError, match=r"(?s)up to 1e\+30.*line 3: found '1e308' in column 'f"):
        read_load_factors(path, ["tip.Fz"])
