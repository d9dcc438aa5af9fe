"""A reduced model that was saved and loaded does what it did before, to the last bit."""

import gc
import pickle
import weakref
from dataclasses import fields, is_dataclass, replace

import h5py
import numpy as np
import pytest
import scipy.sparse as sp

import faying as fy
from faying.exceptions import FormatError, ModelError, StudyError
from faying.export.formats import export
from faying.export.linearized import linearize
from faying.linalg.singular import SingularMatrixError
from faying.model.assembly import NodalLoads
from faying.reduction.projection import for_moving_supports
from lap_joints import tiny_lap

LOAD = fy.Load({"tip.Fz": -500.0, "tip.Mx": 20e3}, name="LC2")
TIMES = {"step": 2e-5, "duration": 30 * 2e-5}


def models(joint):
    """Models of every sort: with and without residual compliance, joint modes, deck loads, law."""
    classic = fy.craig_bampton(joint, normal_modes=6)
    loads = {"5": NodalLoads(nodes=[100, 101], forces=[[0, 40.0, -90.0, 0, 0, 0]] * 2)}
    loaded, hard = joint.with_load_patterns(loads), joint.with_penalty(np.inf)
    return {
        "classic": fy.reduce(joint, classic),
        "compliance": fy.reduce(joint, classic, compliance=True),
        "joint modes": fy.reduce(joint, fy.jim_a(joint, joint_modes=4, classic=classic)),
        "deck load": fy.reduce(loaded, fy.craig_bampton(loaded, normal_modes=6), compliance=True),
        "hard": fy.reduce(hard, classic, compliance=True),
        "moving": for_moving_supports(joint, fy.reduce(joint, classic, compliance=True)),
    }


KINDS = ["classic", "compliance", "joint modes", "deck load", "hard", "moving"]


@pytest.fixture(scope="module")
def damped():
    model = fy.lap_joint(element_size=5.0, damping=fy.Rayleigh(alpha=160.0, beta=5e-7))
    return fy.preload(model, {"bolt": 10e3}, sticking=fy.Sticking())


@pytest.fixture(scope="module")
def before(damped):
    return models(damped)


@pytest.fixture(scope="module")
def after(before, tmp_path_factory):
    folder = tmp_path_factory.mktemp("models")
    found = {}
    for name, rom in before.items():
        rom.save(folder / f"{name}.h5")
        found[name] = fy.read_reduced_model(folder / f"{name}.h5")
    return found


@pytest.fixture
def saved(before, tmp_path):
    path = tmp_path / "joint.h5"
    before["compliance"].save(path)
    return path


def assert_same_bits(found, expected, place=""):
    """Every number of two values is the same."""
    assert type(found) is type(expected) or isinstance(expected, (dict, tuple, list)), place
    if isinstance(expected, np.ndarray):
        np.testing.assert_array_equal(found, expected, err_msg=place)
        assert found.flags.c_contiguous == expected.flags.c_contiguous, place
    elif sp.issparse(expected):
        for part in ("data", "indices", "indptr"):
            assert_same_bits(getattr(found, part), getattr(expected, part), f"{place}.{part}")
    elif is_dataclass(expected):
        for field in fields(expected):
            name = field.name
            assert_same_bits(getattr(found, name), getattr(expected, name), f"{place}.{name}")
    elif isinstance(expected, dict):
        assert list(found) == list(expected), place
        for key in expected:
            assert_same_bits(found[key], expected[key], f"{place}[{key}]")
    elif isinstance(expected, (tuple, list)) and not isinstance(expected, str):
        assert len(found) == len(expected), place
        for number, pair in enumerate(zip(found, expected, strict=True)):
            assert_same_bits(*pair, f"{place}[{number}]")
    else:
        assert found == expected, place


def assert_same_solution(found, expected):
    for name in ("states", "contact_forces", "gap", "inputs", "iterations"):
        np.testing.assert_array_equal(getattr(found, name), getattr(expected, name), err_msg=name)


@pytest.mark.parametrize("name", KINDS)
def test_every_number_comes_back(before, after, name):
    assert_same_bits(after[name], before[name], name)


@pytest.mark.parametrize("name", KINDS)
def test_what_is_computed_of_them_is_the_same(before, after, name):
    here, there = before[name], after[name]
    assert_same_solution(fy.solve_static(there, LOAD), fy.solve_static(here, LOAD))
    one, other = (fy.solve_transient(rom, LOAD, **TIMES) for rom in (there, here))
    assert_same_solution(one, other)
    np.testing.assert_array_equal(one.displacement("tip"), other.displacement("tip"))
    recovered = [
        fy.recover_pressure(rom, motion).pressure for rom, motion in ((there, one), (here, other))
    ]
    np.testing.assert_array_equal(*recovered)
    np.testing.assert_array_equal(*(linearize(rom).frequencies() for rom in (here, there)))


def test_friction_comes_back(tmp_path):
    model = fy.lap_joint(element_size=5.0, penalty=1e5).with_bolt_forces({"bolt": 8e3})
    model = model.with_friction(0.3)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    rom.save(tmp_path / "joint.h5")
    there = fy.read_reduced_model(tmp_path / "joint.h5")
    assert_same_bits(there, rom)


def test_inverses_of_the_full_model_serve_its_reduced_ones(tmp_path):
    """Whoever forms them, also what a file or another process has of the model, finds the same."""
    model = fy.lap_joint(element_size=5.0, penalty=1e5).with_bolt_forces({"bolt": 8e3})
    model = model.with_friction(0.3)
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    pairs = rom.static_contact.increments.pairs
    assert pairs is model.static_contact.increments.pairs
    assert rom.with_bolt_forces({"bolt": 9e3}).static_contact.increments.pairs is pairs
    rom.save(tmp_path / "joint.h5")
    there = fy.read_reduced_model(tmp_path / "joint.h5")
    elsewhere = pickle.loads(pickle.dumps(rom))
    for alike in (there, elsewhere):
        assert alike.static_contact.increments.pairs is not pairs
        assert_same_solution(fy.solve_path(alike, [LOAD]), fy.solve_path(rom, [LOAD]))


def test_recovery_knows_enough_of_the_full_model(damped, before):
    """With the reduced model alone as with the full one: the same matrices."""
    for name in ("classic", "compliance", "joint modes"):
        rom = before[name]
        motion = fy.solve_transient(rom, LOAD, **TIMES)
        for solution in (motion, fy.solve_static(rom, LOAD)):
            alone, whole = (fy.recover_pressure(one, solution) for one in (rom, damped))
            # Contact blocks are factorized anew: round-off of 1e-11 of the largest.
            allowed = 1e-10 * whole.pressure.max()
            np.testing.assert_allclose(alone.pressure, whole.pressure, rtol=0, atol=allowed)


def test_loaded_models_recover_with_the_full_model_too(damped, before, after, tmp_path):
    expected = fy.recover_pressure(damped, fy.solve_transient(before["classic"], LOAD, **TIMES))
    before["classic"].save(tmp_path / "bare.h5", shapes=False)
    for rom in (after["classic"], fy.read_reduced_model(tmp_path / "bare.h5")):
        found = fy.recover_pressure(damped, fy.solve_transient(rom, LOAD, **TIMES))
        # Recovery matrices by the same formulas; round-off of their products.
        allowed = 1e-10 * expected.pressure.max()
        np.testing.assert_allclose(found.pressure, expected.pressure, rtol=0, atol=allowed)


def test_recovery_names_what_does_not_fit(damped, before):
    other = fy.solve_transient(before["joint modes"], LOAD, **TIMES)
    with pytest.raises(ModelError, match="recover with the model that was solved"):
        fy.recover_pressure(before["classic"], other)
    full = fy.solve_static(damped, LOAD)
    with pytest.raises(ModelError, match="recovered with the full model"):
        fy.recover_pressure(before["classic"], full)


def test_displacements_of_the_full_model(damped, before, after):
    static = fy.solve_static(before["classic"], LOAD)
    same = fy.solve_static(after["classic"], LOAD)
    np.testing.assert_array_equal(same.full_displacement(), static.full_displacement())
    exact = fy.solve_static(after["compliance"], LOAD)
    with pytest.raises(ModelError, match=r"faying\.full_displacement\(model, solution\)"):
        exact.full_displacement()
    expected = fy.full_displacement(damped, fy.solve_static(before["compliance"], LOAD))
    np.testing.assert_array_equal(fy.full_displacement(damped, exact), expected)
    with pytest.raises(ModelError, match="give the model that was reduced"):
        fy.full_displacement(fy.lap_joint(element_size=10.0), exact)


def test_model_without_shapes_says_so(before, tmp_path):
    path = tmp_path / "bare.h5"
    before["classic"].save(path, shapes=False)
    before["classic"].save(tmp_path / "whole.h5")
    assert path.stat().st_size < 0.7 * (tmp_path / "whole.h5").stat().st_size
    bare = fy.read_reduced_model(path)
    # A copy, for contact starts from what a model solved before.
    fresh = replace(before["classic"])
    assert_same_solution(fy.solve_static(bare, LOAD), fy.solve_static(fresh, LOAD))
    assert bare.mesh.modes is None
    with pytest.raises(ModelError, match="without its trial vectors"):
        fy.solve_static(bare, LOAD).full_displacement()


@pytest.mark.long
def test_model_of_a_run_is_saved_too(quick_demo, tmp_path):
    from faying.study.stages.recover import results_of

    rom = results_of(quick_demo).reduced["jim-b+compliance"][20]
    rom.save(tmp_path / "joint.h5")
    back = fy.read_reduced_model(tmp_path / "joint.h5")
    np.testing.assert_array_equal(back.mesh.modes, rom.mesh.modes)
    assert_same_solution(fy.solve_static(back, LOAD), fy.solve_static(rom, LOAD))
    assert (back.name, back.method, back.units) == (rom.name, "jim-b+compliance", rom.units)


def test_a_file_is_exported(before, saved):
    paths = export(saved, "npz")
    assert paths == (saved.parent / "compliance.npz",)
    with pytest.raises(StudyError, match="give out="):
        export(before["classic"], "npz")


def test_reduced_model_outlives_the_full_one(tmp_path):
    model = fy.preload(tiny_lap(), {"bolt": 10e3})
    rom = fy.reduce(model, fy.craig_bampton(model, normal_modes=3), compliance=True)
    structure = weakref.ref(model.structure)
    watched = weakref.ref(model)
    full = fy.solve_static(model, LOAD).pressure
    del model
    gc.collect()
    assert watched() is None
    assert structure() is None
    # Static solutions with residual compliance are exact.
    found = fy.solve_static(pickle.loads(pickle.dumps(rom)), LOAD).pressure
    np.testing.assert_allclose(found, full, rtol=0, atol=1e-8 * full.max())


def test_structure_that_nothing_holds_is_reduced_without_recovery(damped, monkeypatch, tmp_path):
    def free(_):
        raise SingularMatrixError(np.zeros(1), "moves freely")

    monkeypatch.setattr(fy.Model, "port_compliance", property(free))
    rom = fy.reduce(damped, fy.craig_bampton(damped, normal_modes=3), compliance=True)
    assert rom.ports is None
    rom.save(tmp_path / "free.h5")
    assert_same_bits(fy.read_reduced_model(tmp_path / "free.h5"), rom)
    with pytest.raises(ModelError, match="does not know the compliance of the full model"):
        _ = rom.joint
    with pytest.raises(ModelError, match="has no recovery matrices"):
        _ = rom.recovery


def test_file_explains_itself_without_faying(saved, before):
    rom = before["compliance"]
    with h5py.File(saved) as file:
        assert file.attrs["format"] == "faying reduced model"
        assert file.attrs["method"] == "compliance"
        assert file.attrs["unit_of_pressure"] == "MPa"
        assert file.attrs["faying"] == fy.__version__
        stiffness = file["reduced/stiffness"]
        np.testing.assert_array_equal(stiffness[()], rom.K)
        assert stiffness.attrs["unit"] == "N/mm"
        assert stiffness.attrs["shape"] == "(n_mode, n_mode)"
        members = []
        file.visit(members.append)
        assert all(file[name].attrs["description"] for name in members)


def test_interrupted_saving_leaves_the_old_file(before, saved, monkeypatch):
    from faying.reduction import model_writer

    content = saved.read_bytes()

    def fail(*_):
        message = "disk full"
        raise OSError(message)

    monkeypatch.setattr(model_writer, "write_members", fail)
    with pytest.raises(FormatError, match=r"cannot write .*joint\.h5: disk full; check the"):
        before["classic"].save(saved)
    assert saved.read_bytes() == content
    assert list(saved.parent.iterdir()) == [saved]


def changed(path, change):
    with h5py.File(path, "r+") as file:
        change(file)
    return path


def emptied(name, shape):
    """Say a shape for which nothing is stored."""

    def change(file):
        del file[name]
        file.create_dataset(name, shape=shape, dtype=float, chunks=(1000, 10))

    return change


def linked(name, link):
    def change(file):
        del file[name]
        file[name] = link

    return change


def set_to(name, value):
    def change(file):
        del file[name]
        file[name] = value

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda f: f.attrs.__setitem__("format", "another"), "but holds no faying reduced model"),
        (lambda f: f.attrs.__setitem__("format_version", 99), r"format 99, this faying reads 1"),
        (lambda f: f.__delitem__("reduced/mass"), "/reduced/mass is missing"),
        (lambda f: f.__delitem__("ports"), "/ports is missing"),
        (emptied("reduced/mass", (10**6, 10**6)), r"has shape .* but stores 0"),
        (emptied("reduced/trial_vectors", (10**7, 13)), r"has shape .* but stores 0"),
        (linked("reduced/mass", h5py.ExternalLink("other.h5", "mass")), "is a link to another"),
        (linked("ports", h5py.SoftLink("/reduced")), "is a link to another place"),
        (set_to("reduced/mass", np.eye(3)), r"'/reduced/mass' has shape \(3, 3\), expected"),
        (set_to("reduced/mass", "heavy"), "does not hold numbers"),
        (set_to("reduced/stiffness", np.full((13, 13), np.nan)), "are not finite"),
        (set_to("ports/bolt_stiffness/bolt", np.nan), "stiffness/bolt' holds numbers that are not"),
        (lambda f: f["interfaces/joint/initial_gap"].__setitem__(3, np.nan), "gap' holds numbers"),
        (lambda f: f["interfaces/joint/points"].__setitem__((3, 1), np.inf), "are not finite"),
        (set_to("laws/joint/law", "glue"), "contact law 'glue'; known are hard, penalty, coulomb"),
        (
            set_to("reduced/boundary", np.full(6, 99)),
            "boundary' holds indices from 99",
        ),
        (set_to("reduced/kinds", ["odd"] * 13), "'odd' is not a valid ModeKind"),
        (set_to("ports/interpolation/columns", np.zeros(3, int)), "damaged"),
        (set_to("interfaces/joint/slice", [0, 3]), "interfaces have 112 points"),
        (set_to("interfaces/joint/averaging", 1.0), r"joint/averaging' has shape \(\), expected"),
        (set_to("interfaces/joint/initial_gap", np.zeros(7)), r"initial_gap' has shape \(7,\)"),
        (
            lambda f: f["interfaces/joint/pairs"].__setitem__((0, 0), -9),
            "pairs' holds indices",
        ),
        (set_to("interfaces/joint/stuck", np.zeros(3, bool)), r"stuck' has shape \(3,\)"),
    ],
)
def test_damaged_files_end_in_one_message(saved, change, message):
    with pytest.raises(FormatError, match=message) as error:
        fy.read_reduced_model(changed(saved, change))
    assert len(str(error.value).splitlines()) == 1


def test_other_files_end_in_one_message(tmp_path, saved):
    with pytest.raises(FormatError, match="does not exist"):
        fy.read_reduced_model(tmp_path / "none.h5")
    (tmp_path / "text.h5").write_text("hello")
    with pytest.raises(FormatError, match="is not an HDF5 file"):
        fy.read_reduced_model(tmp_path / "text.h5")
    saved.write_bytes(saved.read_bytes()[:-5000])
    with pytest.raises(FormatError, match=r"cut off|damaged"):
        fy.read_reduced_model(saved)


def test_flipped_bit_in_an_array_is_found(saved):
    with h5py.File(saved) as file:
        chunk = file["ports/compliance"].id.get_chunk_info(0)
    content = bytearray(saved.read_bytes())
    content[chunk.byte_offset + chunk.size // 2] ^= 1
    saved.write_bytes(content)
    with pytest.raises(FormatError, match="damaged"):
        fy.read_reduced_model(saved)


@pytest.fixture
def large(damped):
    """Of an interface that dense matrices have no room for."""
    small = damped.with_dense_budget(1000)
    rom = fy.reduce(small, fy.craig_bampton(small, normal_modes=3), compliance=True)
    assert not isinstance(rom.contact.residual_compliance, np.ndarray)
    return rom


def test_compliance_that_is_not_formed_is_kept_to_the_bit(large, tmp_path):
    large.save(tmp_path / "joint.h5")
    same = fy.read_reduced_model(tmp_path / "joint.h5")
    load = fy.Load({"tip.Fz": -300.0})
    for one, other in (
        (fy.solve_static(large, load), fy.solve_static(same, load)),
        (
            fy.solve_transient(large, load, duration=2e-4, step=2e-5),
            fy.solve_transient(same, load, duration=2e-4, step=2e-5),
        ),
    ):
        assert np.ptp(one.pressure) > 0
        np.testing.assert_array_equal(one.pressure, other.pressure)
    forces = np.linspace(-1.0, 1.0, same.ports.n_relative)
    np.testing.assert_array_equal(large.ports.per_contact(forces), same.ports.per_contact(forces))


@pytest.mark.parametrize(
    ("part", "spoil"),
    [
        ("shapes", lambda v: v[:, :-1]),
        ("shapes", lambda v: v[1:]),
        ("core", lambda v: v[:-1]),
        ("core", lambda v: v * np.nan),
        ("matrix/values", lambda v: v * np.nan),
        ("matrix/shape", lambda v: v + 1),
        ("ports/shape", lambda v: v + 1),
        ("matrix", None),
    ],
)
def test_parts_of_a_compliance_that_do_not_fit_are_refused(large, tmp_path, part, spoil):
    large.save(tmp_path / "joint.h5")
    with h5py.File(tmp_path / "joint.h5", "r+") as file:
        group = file["reduced/residual_compliance"]
        value = None if spoil is None else spoil(group[part][()])
        del group[part]
        if value is not None:
            group[part] = value
    with pytest.raises(FormatError, match=r"has shape|not finite|index|matrix is missing"):
        fy.read_reduced_model(tmp_path / "joint.h5")


def test_the_former_name_of_the_reader_warns():
    with pytest.warns(DeprecationWarning, match="faying.read_reduced_model now"):
        assert fy.load is fy.read_reduced_model
