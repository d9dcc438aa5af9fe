"""What values say of themselves: in a line, in a notebook, as tables with units."""

import sys
from dataclasses import dataclass

import numpy as np
import pytest
from typer.testing import CliRunner

import faying as fy
from faying.cli import app
from faying.display.facts import Shown
from faying.exceptions import ModelError, StudyError


@pytest.fixture(scope="module")
def load():
    return fy.Load({"tip.Fz": -500.0}, name="LC1")


@pytest.fixture(scope="module")
def static(joint, load):
    return fy.solve_static(joint, load)


@pytest.fixture(scope="module")
def moving(joint, classic, load):
    return fy.solve_transient(fy.reduce(joint, classic), load, step=1e-5, duration=3e-5)


def test_values_say_what_they_are_in_a_line(joint, classic, static):
    rom = fy.reduce(joint, classic)
    accuracy = fy.compare(fy.solve_static(rom, fy.Load({"tip.Fz": -500.0})), static)
    n_node = len(joint.assembly.mesh.nodes)
    wanted = {
        joint: f"nodes: {n_node}, solid elements: {joint.assembly.mesh.n_elements}, ",
        joint.interfaces["joint"]: "name: joint, node pairs: ",
        classic: f"trial vectors: {len(classic)} (6 constraint, 10 normal, 1 bolt), ",
        rom: "residual compliance: no, interfaces: 1 (joint), bolts: 1 (bolt), boundaries: 1 (tip)",
        static: f"name: LC1, model: {joint.name}, kind: static, contact points: 112, ",
        accuracy: f"max relative error: {100 * accuracy.max_relative_error:.3g} %, ",
    }
    for value, said in wanted.items():
        assert said in repr(value)
        assert "\n" not in repr(value)
        assert len(repr(value)) < 400
        html = value._repr_html_()
        assert html.count("<tr>") == len(value.facts)
        assert all(meaning in html for meaning in value.facts)
    assert f"largest pressure: {static.max_pressure:.4g} MPa" in repr(static)


def test_transients_say_how_far_they_go(moving):
    assert "kind: 4 instants up to 3e-05 s" in repr(moving)


def test_names_are_text_in_a_notebook():
    @dataclass(frozen=True, repr=False)
    class Evil(Shown):
        @property
        def facts(self):
            return {"name": "<script>&"}

    assert "&lt;script&gt;&amp;" in Evil()._repr_html_()
    assert repr(Evil()) == "Evil(name: <script>&)"


def test_table_of_a_static_solution_has_every_point_once(joint, static):
    pytest.importorskip("pandas", reason="pandas is not installed")
    table = static.to_dataframe()
    interface = joint.interfaces["joint"]
    assert list(table["interface"].unique()) == ["joint"]
    assert np.array_equal(table["pressure"], static.pressure)
    assert np.array_equal(table[["x", "y", "z"]], interface.points)
    assert (table["area"] * table["pressure"]).sum() == pytest.approx(static.contact_force())
    units = table.attrs["units"]
    assert set(units) == set(table.columns)
    assert (units["pressure"], units["gap"], units["area"]) == ("MPa", "mm", "mm²")


def test_table_of_a_transient_goes_instant_by_instant(moving):
    pytest.importorskip("pandas", reason="pandas is not installed")
    table = moving.to_dataframe()
    assert len(table) == moving.gap.size
    last = table[table["time"] == moving.times[-1]]
    assert np.array_equal(last["gap"], moving.gap[-1])
    assert table.attrs["units"]["time"] == "s"


def test_labelled_arrays_hold_points_bolts_and_boundaries(joint, load, static, moving):
    pytest.importorskip("xarray", reason="xarray is not installed")
    found = moving.to_xarray()
    assert found["pressure"].dims == ("time", "point")
    assert found["pressure"].attrs["units"] == "MPa"
    assert found["time"].attrs["units"] == "s"
    assert np.array_equal(found["bolt_force"].sel(bolt="bolt"), moving.bolt_force("bolt"))
    tip = found["displacement_tip"].sel(component_tip="uz")
    assert np.array_equal(tip, moving.displacement("tip")[:, 2])
    assert static.to_xarray()["gap"].dims == ("point",)
    cases = fy.solve_static_cases(joint, [load, fy.Load({"tip.Fz": 100.0})])
    assert cases.to_xarray()["pressure"].dims == ("case", "point")
    named = moving.to_xarray()["interface"].values
    assert set(named) == {"joint"}


@pytest.mark.parametrize(("name", "method"), [("pandas", "to_dataframe"), ("xarray", "to_xarray")])
def test_what_is_missing_is_named(static, monkeypatch, name, method):
    monkeypatch.setitem(sys.modules, name, None)
    with pytest.raises(ModelError, match=rf"{name}, which is not installed; pip install 'faying\["):
        getattr(static, method)()


def test_view_opens_the_report_or_says_where_it_is(tmp_path, monkeypatch):
    opened = []
    monkeypatch.setattr("webbrowser.open", lambda address: opened.append(address) or True)
    run = CliRunner().invoke
    with pytest.raises(StudyError, match="holds no report"):
        run(app, ["view", str(tmp_path)], catch_exceptions=False)
    page = tmp_path / "report.html"
    page.write_text("", encoding="utf-8")
    said = run(app, ["view", str(tmp_path), "--no-browser"], catch_exceptions=False)
    assert said.output.replace("\n", "") == str(page.resolve())
    assert opened == []
    run(app, ["view", str(tmp_path)], catch_exceptions=False)
    assert opened == [page.resolve().as_uri()]
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    said = run(app, ["view", str(tmp_path)], catch_exceptions=False)
    assert str(page.resolve()) in said.output.replace("\n", "")
