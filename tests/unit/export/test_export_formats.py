"""Every format writes its files whole, over existing ones too; the command says what it wrote."""

import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import h5py
import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, StudyError
from faying.export import vtk
from faying.export.formats import CONTACT, CURVES, FORMATS, LINEAR, MEANINGS, default_name, export
from faying.reduction.projection import completed, nodal_shapes
from faying.study.stages.recover import results_of


@pytest.fixture(scope="module")
def run(quick_demo):
    return results_of(quick_demo)


@pytest.fixture(scope="module")
def given(run):
    return run.reduced["compliance"][0]


@pytest.fixture
def format_module(monkeypatch):
    """A format whose module the test provides."""

    def install(write):
        module = ModuleType("faying.export.npz_stand_in")
        module.write = write
        monkeypatch.setitem(sys.modules, FORMATS["npz"].module, module)

    return install


def usable(name):
    """Return a format, or skip where its extra is not installed."""
    chosen = FORMATS[name]
    if chosen.kind == CURVES:
        pytest.skip("it writes responses of a run: tests/interop/test_uff.py")
    if chosen.extra:
        pytest.importorskip(chosen.extra, reason=f"the extra {chosen.extra} is not installed")
    return chosen


def contents(folder):
    return {path.relative_to(folder): path for path in folder.rglob("*") if path.is_file()}


@pytest.mark.long
@pytest.mark.parametrize("name", FORMATS)
def test_format_writes_its_files(run, tmp_path, name):
    chosen = usable(name)
    target = tmp_path / f"joint{chosen.suffix}"
    paths = export(run, name, out=target)
    assert paths
    assert len(set(paths)) == len(paths)
    assert set(contents(tmp_path).values()) == set(paths)  # all of them returned, nothing left over
    assert all(path.stat().st_size > 0 for path in paths)
    assert paths[0] == target or target in paths[0].parents or paths[0].stem == target.stem
    assert export(run, name, out=target) == paths
    assert set(contents(tmp_path).values()) == set(paths)


@pytest.mark.long
@pytest.mark.parametrize("name", FORMATS)
def test_format_needs_no_run(joint, classic, tmp_path, name):
    """A model made in Python has no load cases, and that is all it lacks."""

    import faying as fy

    chosen = usable(name)
    own = replace(fy.reduce(joint, classic, compliance=True), name="mine")
    assert export(own, name, out=tmp_path / f"joint{chosen.suffix}")


@pytest.mark.parametrize("name", FORMATS)
def test_every_format_has_its_class_and_meaning(name):
    assert FORMATS[name].kind in MEANINGS
    assert FORMATS[name].module.startswith("faying.export.")
    assert (FORMATS[name].kind == LINEAR) == (name == "nastran")


def test_default_names_do_not_meet(run, given):
    """Neither do those of files beside them: a module keeps its matrices under its own name."""
    names = [default_name(given, to) for to in FORMATS]
    assert len({Path(name).stem for name in names if Path(name).suffix in (".py", ".npz")}) == 2
    assert len(set(names)) == len(FORMATS)
    several = run.reduced["jim-b+compliance"][20]
    assert default_name(several, "mat") == "jim-b+compliance-20.mat"
    assert Path(default_name(several, "exudyn")).stem.isidentifier()


def test_failure_leaves_what_was_there(given, tmp_path, format_module):
    target = tmp_path / "joint.npz"
    target.write_bytes(b"old")

    def write(_, path, run):
        path.write_bytes(b"half")
        raise OSError(28, "No space left on device")

    format_module(write)
    with pytest.raises(FormatError, match="No space left"):
        export(given, "npz", out=target)
    assert target.read_bytes() == b"old"
    assert list(tmp_path.iterdir()) == [target]


def test_files_keep_their_places_beside_the_first(given, tmp_path, format_module):
    def write(_, path, run):
        inner = path.parent / "parts" / "one.bin"
        inner.parent.mkdir()
        for file in (path, inner):
            file.write_bytes(b"whole")
        return path, inner

    format_module(write)
    paths = export(given, "npz", out=tmp_path / "new" / "joint")
    assert paths == (tmp_path / "new" / "joint.npz", tmp_path / "new" / "parts" / "one.bin")
    assert (paths[1].stat().st_mode & 0o777) == 0o644


def test_missing_extra_is_named(given, tmp_path, format_module):
    def write(*_):
        import a_package_nobody_has  # noqa: F401

    format_module(write)
    with pytest.raises(StudyError, match=r"npz needs 'a_package_nobody_has'.* pip install"):
        export(given, "npz", out=tmp_path / "joint.npz")


@pytest.mark.long
@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--to", "nastrn"], "did you mean 'nastran'"),
        (["--to", "npz", "--method", "jim"], "no reduced model 'jim'"),
        (["--to", "npz", "--method", "jim-b", "--joint-modes", "7"], "with 7 joint modes"),
    ],
)
def test_wrong_wishes_are_one_message(call, quick_demo, arguments, message):
    status, out, err = call("export", quick_demo, *arguments)
    assert status == 2
    assert out == ""
    assert message in err
    assert len(err.strip().splitlines()) == 1


@pytest.mark.long
def test_wrong_places_are_one_message(call, quick_demo, tmp_path):
    status, _, err = call("export", tmp_path, "--to", "npz")
    assert status == 2
    assert "no results.h5" in err
    for target in (tmp_path, quick_demo / "results.h5" / "joint.npz"):
        status, _, err = call("export", quick_demo, "--to", "npz", "--out", target)
        assert status == 2
        assert str(target) in err


@pytest.mark.long
def test_command_says_what_it_wrote(call, quick_demo, tmp_path):
    target = tmp_path / "pictures"
    status, out, _ = call(
        "export",
        quick_demo,
        "--to",
        "vtk",
        "--method",
        "jim-b",
        "--out",
        target,
    )
    assert status == 0
    for expected in [
        "Pictures: fields for viewers; no model is exported",
        "jim-b with 20 joint modes, ",
        "Units: mm, t, s, N, MPa",
        f"Wrote {target / 'structure.vtu'}",
        f"Wrote {target / 'interface_joint_LC2-step'} (",
    ]:
        assert expected in out


@pytest.mark.long
def test_class_of_a_hand_over_is_said_first(call, quick_demo, format_module, tmp_path):
    def write(_, path, run):
        path.write_bytes(b"whole")
        return (path,)

    format_module(write)
    target = tmp_path / "joint.npz"
    status, out, _ = call("export", quick_demo, "--to", "npz", "--out", target)
    assert status == 0
    assert out.lower().startswith(CONTACT)
    assert out.rstrip().endswith(f"Wrote {target}")


def test_shapes_move_the_boundary_as_its_coordinates_say(given):
    """Constraint modes: a unit of a boundary coordinate moves its node by one, others by none."""
    node = {int(number): place for place, number in enumerate(given.mesh.node_ids)}
    for name, boundary in given.boundaries.items():
        for dof, number, component in zip(
            boundary.dofs, boundary.nodes, boundary.components, strict=True
        ):
            if component < 3:
                column = given.mesh.modes[:, node[int(number)], component]
                expected = np.zeros(len(column))
                expected[dof] = 1.0
                np.testing.assert_allclose(column, expected, atol=1e-9, err_msg=name)


def test_shapes_are_stored_once(run, given):
    """craig-bampton and compliance share theirs, jim adds its own."""
    everyone = [rom for sizes in run.reduced.values() for rom in sizes.values()]
    assert given.mesh.modes.shape == (len(given.K), len(run.nodes), 3)
    distinct = {tuple(rom.mesh.columns) for rom in run.reduced["compliance"].values()}
    assert distinct == {tuple(rom.mesh.columns) for rom in run.reduced["craig-bampton"].values()}
    assert {id(rom.mesh.vectors) for rom in everyone} == {id(given.mesh.vectors)}
    assert given.mesh.vectors.shape[1] < sum(len(rom.K) for rom in everyone)


def test_shapes_give_the_static_displacements(run):
    """Σ q shape is the displacement field the run stored of a model without compliance."""
    from faying.simulation.load import Load
    from faying.simulation.path import solve_static

    classic = run.reduced["craig-bampton"][0]
    solution = solve_static(classic, Load({"tip.Fz": -500.0, "tip.Mx": 20e3}))
    field = np.tensordot(solution.states, classic.mesh.modes, axes=1)
    methods = run.cases["LC2"].methods
    stored = methods["craig-bampton"][0].response.nodal_displacement
    # The same model restored from the file: round-off of its factorization.
    np.testing.assert_allclose(field, stored, atol=1e-7 * np.abs(stored).max())


def test_stored_displacements_of_exact_methods_are_those_of_the_full_model(run):
    case = run.cases["LC2"]
    exact = case.reference.nodal_displacement
    for name in ("compliance", "jim-a+compliance", "jim-b+compliance"):
        for result in case.methods[name].values():
            found = result.response.nodal_displacement
            # 1e-7: gaps of 1e-4 of the tip's motion close to round-off of a stiff penalty.
            np.testing.assert_allclose(found, exact, rtol=0, atol=1e-7 * np.abs(exact).max())


@pytest.mark.long
def test_results_without_shapes_are_still_handed_over(quick_demo, tmp_path):
    """Of an older version, or beyond the limit."""
    copy = tmp_path / "results.h5"
    copy.write_bytes((quick_demo / "results.h5").read_bytes())
    with h5py.File(copy, "r+") as file:
        del file["shapes"]
        for sizes in file["reduced"].values():
            for record in sizes.values():
                del record["shapes"]
    old = results_of(tmp_path)
    assert old.reduced["compliance"][0].mesh.modes is None
    names = {path.name for path in export(old, "vtk", out=tmp_path / "pictures")}
    assert "structure.vtu" in names
    assert "modes.vtu" not in names


def test_shapes_that_exceed_the_limit_are_left_out(joint, classic):
    one = 24 * joint.dofs.n_nodes
    shapes = nodal_shapes(joint, classic, most_bytes=5 * one + 1)
    assert shapes.nbytes == 5 * one
    whole = joint.dofs.nodal(classic.vectors[:, :5].T)[..., :3]
    # Sums of a handful of products each.
    np.testing.assert_allclose(shapes, whole, rtol=1e-12, atol=1e-15)


def test_shapes_are_kept_for_models_whose_shapes_all_fit(joint, classic):
    few, many = (
        fy.reduce(joint, fy.craig_bampton(joint, normal_modes=count), compliance=False)
        for count in (1, 9)
    )
    room = 24 * joint.dofs.n_nodes * (len(many.basis) - 1)
    with_shapes, without = completed(joint, [few, many], most_bytes=room)
    assert with_shapes.mesh.vectors.shape[1] == len(few.basis)
    assert without.mesh.vectors is None
    assert without.invariants is None


def test_long_series_are_thinned(run, tmp_path, monkeypatch):
    monkeypatch.setattr(vtk, "MOST_INSTANTS", 5)
    paths = export(run, "vtk", out=tmp_path / "pictures")
    instants = [path for path in paths if path.parent.name == "interface_joint_LC2-step"]
    assert len(instants) == 5
    times = run.cases["LC2-step"].times
    series = (tmp_path / "pictures" / "interface_joint_LC2-step.pvd").read_text()
    assert series.count("<DataSet") == 5
    assert f'timestep="{float(times[0])!r}"' in series
    assert f'timestep="{float(times[-1])!r}"' in series
