"""Results files of strangers: read whole, or refused in one message that names the entry."""

import os
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest

from fake_results import fake_results
from faying.exceptions import FormatError
from faying.files import hdf5
from faying.joint.system import PortableJoint
from faying.study.results.store import read_results, write_results
from faying.study.stages.imported_history import read_imported_history

RESULTS = fake_results()


@pytest.fixture
def path(whole, tmp_path):
    return Path(shutil.copy(whole[0], tmp_path / "results.h5"))


def refused(path, change):
    with h5py.File(path, "a") as file:
        change(file)
    with pytest.raises(FormatError) as caught:
        read_results(path)
    assert "\n" not in str(caught.value)
    assert str(path) in str(caught.value)
    return str(caught.value)


def put(name, value, **options):
    def change(file):
        if name in file:
            del file[name]
        file.create_dataset(name, data=value, **options)

    return change


def edit(name, function):
    return lambda file: put(name, function(file[name][()]))(file)


def link(name, to):
    def change(file):
        del file[name]
        file[name] = to

    return change


def with_an_endless_heap(data):
    """Change one byte: the last text of a heap becomes longer, up to zeros that read as texts.

    HDF5 2.0 goes on from a text without length to the same place, for ever.
    """
    damaged, place = bytearray(data), data.rindex(b"GCOL") + 16
    while True:
        size = int.from_bytes(data[place + 8 : place + 16], "little")
        following = place + 16 + -(-size // 8) * 8
        if not any(data[following : following + 2]):  # what is not used has no number
            break
        place = following
    damaged[place + 8] += 24
    assert not any(data[following + 16 : following + 64])
    return bytes(damaged)


@pytest.mark.long
def test_byte_on_which_hdf5_stalls(path, monkeypatch):
    monkeypatch.setattr(hdf5, "STALLED_SECONDS", 1.0)
    whole = path.read_bytes()
    path.write_bytes(with_an_endless_heap(whole))
    with pytest.raises(FormatError, match="the HDF5 library crashes or stalls on it"):
        read_results(path)
    path.write_bytes(whole)
    assert read_results(path).title == RESULTS.title


@pytest.mark.long
def test_process_that_looks_is_started_anew_and_takes_no_modules_of_the_folder(
    path, tmp_path, monkeypatch
):
    """It may have been killed, for its memory; and a stranger's folder is no place for code."""
    read_results(path)
    (watch,) = hdf5._WATCHES.values()
    watch.kill()
    watch.wait()
    for name in ("h5py", "numpy", "json"):
        (tmp_path / f"{name}.py").write_text("raise SystemExit('code of a stranger')")
    monkeypatch.chdir(tmp_path)
    assert read_results(path).title == RESULTS.title


@pytest.mark.long
def test_other_files_are_not_opened(path, tmp_path):
    os.mkfifo(tmp_path / "pipe")  # whoever opens it waits for ever
    for name in ("nodes", "interfaces", "cases/LC1/reference"):
        to = h5py.ExternalLink(str(tmp_path / "pipe"), "/nodes")
        assert "is a link to another place" in refused(path, link(name, to))
        write_results(RESULTS, path)
    assert "is a link" in refused(path, link("nodes", h5py.SoftLink("/node_ids")))


def test_data_in_other_files(path, tmp_path):
    (tmp_path / "secret").write_bytes(bytes(8 * 3 * len(RESULTS.nodes)))

    def external(file):
        shape = file["nodes"].shape
        del file["nodes"]
        file.create_dataset("nodes", shape, "f8", external=str(tmp_path / "secret"))

    assert "not a dataset that holds its own data" in refused(path, external)

    def virtual(file):
        layout = h5py.VirtualLayout(file["nodes"].shape, "f8")
        layout[:] = h5py.VirtualSource(str(tmp_path / "other.h5"), "nodes", layout.shape)
        del file["nodes"]
        file.create_virtual_dataset("nodes", layout)

    write_results(RESULTS, path)
    assert "not a dataset that holds its own data" in refused(path, virtual)


def test_groups_that_go_round_in_circles(path):
    assert "second name" in refused(path, lambda file: link("provenance", file["/"])(file))
    write_results(RESULTS, path)
    assert "second name" in refused(path, lambda file: link("node_ids", file["body"])(file))


def test_sizes_beyond_the_file(path):
    def huge(file):
        del file["nodes"]
        options = {"chunks": (1000, 100), "compression": "gzip"}
        file.create_dataset("nodes", (10**10, 100), "f8", **options)

    assert "has shape (10000000000, 100), 8e+12 bytes, but stores 0" in refused(path, huge)


@pytest.mark.long
def test_sizes_beyond_the_memory(path, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "1e7")
    zeros = put("nodes", np.zeros((10**6, 3)), compression="gzip")
    assert "holds 0.024 GB, and 0.01 GB of memory are free" in refused(path, zeros)
    monkeypatch.setenv("FAYING_MEMORY", "1e4")
    write_results(RESULTS, path)
    with pytest.raises(FormatError, match="of memory are free"):
        read_results(path)


def test_one_text_many_times(path, monkeypatch):
    """Entries of variable length may all be the same place in the file."""
    long = "x" * 2**17

    def many(file):
        del file["warnings"]
        kind = h5py.string_dtype()
        data = file.create_dataset("warnings", (600,), kind, chunks=(600,), compression="gzip")
        data[...] = [long] * 600

    monkeypatch.setenv("FAYING_MEMORY", "5e7")
    assert "of memory are free" in refused(path, many)


@pytest.mark.parametrize("version", ["one", np.arange(3), 7, 1.5, h5py.Empty("f8")])
def test_version_that_is_no_number(path, version):
    def change(file):
        file.attrs["format_version"] = version

    refused(path, change)


INTERFACE = "interfaces/joint"
REFERENCE = "cases/LC1/reference"


@pytest.mark.parametrize(
    ("change", "place"),
    [
        (edit("blocks/0/nodes", lambda a: a + 10**6), "/blocks/0/nodes"),
        (edit("blocks/0/nodes", lambda a: a - 10**6), "/blocks/0/nodes"),
        (edit("blocks/0/nodes", lambda a: a[:, :4]), "/blocks/0/nodes"),
        (edit("blocks/0/ids", lambda a: a[:-1]), "/blocks/0/ids"),
        (put("blocks/0/kind", "hex9"), "/blocks/0/kind"),
        (edit("nodes", lambda a: a[:, :2]), "/nodes"),
        (edit("nodes", lambda a: a * np.nan), "/nodes"),
        (put("nodes", "text"), "/nodes"),
        (edit(f"{INTERFACE}/pairs", lambda a: a + 10**6), "/interfaces/joint/pairs"),
        (edit(f"{INTERFACE}/faces/0/minus", lambda a: a[::-1]), "/interfaces/joint/faces"),
        (edit(f"{INTERFACE}/slice", lambda a: a + 1), "/interfaces/joint/slice"),
        (edit(f"{INTERFACE}/averaging", lambda a: a[:, :-1]), "/interfaces/joint/averaging"),
        (edit(f"{REFERENCE}/pressure", lambda a: a[:-1]), "/cases/LC1/reference/pressure"),
        (edit(f"{REFERENCE}/pressure", lambda a: a[None]), "/cases/LC1/reference/pressure"),
        (edit(f"{REFERENCE}/displacements/tip", lambda a: a[:-1]), "displacements/tip"),
        (edit("bolts/bolt/history", lambda a: a[:-1]), "/bolts/bolt/history"),
        (lambda file: file.move("bolts/bolt", "bolts/nut"), "bolt_forces"),
        (edit(f"{INTERFACE}/weights", lambda a: -a), "/interfaces/joint' has a negative weight"),
        (edit(f"{INTERFACE}/penalty", lambda a: -a), "no positive penalty"),
    ],
)
def test_entries_that_contradict_each_other(path, change, place):
    assert place in refused(path, change)


def test_histories_of_strangers(tmp_path):
    """The same guard, and no size of its own."""
    path, joint = tmp_path / "q.h5", object.__new__(PortableJoint)
    os.mkfifo(tmp_path / "pipe")
    with h5py.File(path, "w") as file:
        file["times"] = h5py.ExternalLink(str(tmp_path / "pipe"), "/times")
    with pytest.raises(FormatError, match="is a link to another place"):
        read_imported_history(path, joint)
    with h5py.File(path, "w") as file:
        file.create_dataset("times", (10**12,), "f8", chunks=(1000,), compression="gzip")
    with pytest.raises(FormatError, match="has shape"):
        read_imported_history(path, joint)


NUMBERS = [-1, 0, 1, 2, 10**6, 2**40]
TEXTS = ["", "x", "nan", "../../x", "[/b]", "<b>", "$x_{", "\x1b[2J"]


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "whole.h5"
    write_results(RESULTS, path)
    names = []
    with h5py.File(path) as file:
        file.visit(names.append)
    return path, names


@pytest.mark.long
@pytest.mark.parametrize("seed", range(60))
def test_damaged_results(whole, seed):
    original, names = whole
    draw = np.random.default_rng(seed).integers
    # A name of its own: HDF5 may remember what a file of the same name held.
    path = original.with_name(f"damaged-{seed}.h5")
    path.write_bytes(original.read_bytes())
    with h5py.File(path, "a") as file:
        for _ in range(draw(1, 3)):
            name, way, choice = names[draw(len(names))], draw(10**6), draw(10**6)
            if name in file:
                damage(file, name, way, choice, NUMBERS[draw(len(NUMBERS))])
    try:
        read_results(path)
        said = ""
    except FormatError as error:
        said = str(error)
    path.unlink()
    assert "\n" not in said


def damage(file, name, way, choice, number):
    kinds = ["lost", "group", "soft", "again", "kind"]
    node = file[name]
    if isinstance(node, h5py.Dataset) and node.dtype.kind in "if":
        kinds += ["entry", "axis", "cut"] * 3
    elif isinstance(node, h5py.Dataset):
        kinds += ["text"] * 4
    kind, values = kinds[way % len(kinds)], None
    if kind in ("entry", "axis", "cut"):
        values = np.array(node[()])

    def one_of(options):
        return options[choice % len(options)]

    again = one_of(["/", "/nodes", "/interfaces"])
    del file[name]
    if kind == "group":
        file.create_group(name)
    elif kind == "soft":
        file[name] = h5py.SoftLink(one_of(["/", "/nodes", f"/{name}"]))
    elif kind == "again" and again in file:
        file[name] = file[again]
    elif kind == "kind":
        file[name] = one_of([1.5, "text", True, np.arange(3), np.ones(2) * 1j])
    elif kind == "text":
        file[name] = one_of(TEXTS)
    elif kind == "axis":
        file[name] = values[None]
    elif kind == "cut":
        file[name] = np.atleast_1d(values)[: choice % 3]
    elif kind == "entry":
        if values.size:
            values.reshape(-1)[choice % values.size] = number
        file[name] = values


KEPT = "reduced/compliance/0"
PORTS = "ports"


@pytest.mark.long
@pytest.mark.parametrize(
    ("change", "place"),
    [
        (edit(f"{KEPT}/stiffness", lambda a: -a), "stiffness' has negative eigenvalues"),
        (edit(f"{KEPT}/stiffness", lambda a: np.triu(a)), "stiffness' is not symmetric"),
        (edit(f"{KEPT}/boundary", lambda a: 0 * a), "boundary' names a coordinate twice"),
        (edit(f"{KEPT}/boundary", lambda a: a + 1000), "boundary' holds indices"),
        (edit(f"{PORTS}/compliance", lambda a: -a), "/ports/compliance' has negative eigenvalues"),
        (edit(f"{PORTS}/boundaries/tip/components", lambda a: a + 10), "holds others than 0 to 5"),
        (edit(f"{PORTS}/boundaries/tip/components", lambda a: 0 * a), "a degree of freedom twice"),
        (edit(f"{PORTS}/boundaries/tip/nodes", lambda a: a + 10**9), "is not among the nodes"),
    ],
)
def test_reduced_models_that_cannot_be(quick_demo, tmp_path, change, place):
    path = tmp_path / "results.h5"
    path.write_bytes((quick_demo / "results.h5").read_bytes())
    assert place in refused(path, change)
