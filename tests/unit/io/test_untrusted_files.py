"""Files from strangers: sizes known before there is memory for them, nothing run or endless."""

import io
import os
import pickle
import tracemalloc
import zipfile
from pathlib import Path

import numpy as np
import pytest
import scipy.io

import faying as fy
from faying.exceptions import FormatError, StudyError
from faying.files.numpy_archive import read_matrices
from faying.io.abaqus.deck import DIALECT
from faying.io.deck_lines import read_lines
from faying.io.isolated import read_isolated
from faying.io.matrix_tables import read_matrix, read_node_table
from faying.io.mesh_files import read_mesh_file
from faying.io.nastran.tokenizer import read_source
from faying.study.keys.schema import read_study


def refused(read, *arguments):
    with pytest.raises((FormatError, StudyError)) as caught:
        read(*arguments)
    assert "\n" not in str(caught.value)
    return str(caught.value)


class Planted:
    """Leaves a trace where it is unpickled."""

    def __reduce__(self):
        return (Path.mkdir, (Path("run-by-a-pickle"),))


@pytest.mark.parametrize("read", [lambda path: read_matrix(path, "K"), read_node_table])
def test_pickles_are_not_run(tmp_path, monkeypatch, read):
    monkeypatch.chdir(tmp_path)
    np.savez("K.npz", K=np.array([Planted()], dtype=object))
    assert "pickled objects, which may run code" in refused(read, Path("K.npz"))
    Path("K.mat").write_bytes(pickle.dumps(Planted()))
    refused(read_matrix, Path("K.mat"), "K")
    assert not Path("run-by-a-pickle").exists()


def archive(path, shape, held=b"\0" * 64):
    header = io.BytesIO()
    text = {"descr": "<f8", "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(header, text)
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        file.writestr("K.npy", header.getvalue() + held)


@pytest.mark.parametrize("read", [lambda path: read_matrix(path, "K"), read_node_table])
def test_bombs_of_numpy(tmp_path, monkeypatch, read):
    archive(tmp_path / "a.npz", (10**6, 10**6))
    assert "has shape (1000000, 1000000)" in refused(read, tmp_path / "a.npz")
    archive(tmp_path / "b.npz", (1000, 1000), bytes(8_000_000))
    assert (tmp_path / "b.npz").stat().st_size < 10_000
    monkeypatch.setenv("FAYING_MEMORY", "1e6")
    assert " GB, and 0.001 GB of memory are free" in refused(read, tmp_path / "b.npz")


@pytest.mark.long
def test_readers_of_scipy_meet_damage_in_a_process_of_their_own(tmp_path, monkeypatch):
    path = tmp_path / "K.mat"
    # What is not zero is what takes memory.
    scipy.io.savemat(path, {"K": np.diag(np.arange(1.0, 1415.0))}, do_compression=True)
    assert read_matrix(path, "K").matrix.nnz == 1414
    path.write_bytes(path.read_bytes()[:-1] + b"?")
    assert "K.mat' cannot be read" in refused(read_matrix, path, "K")
    path, heading = tmp_path / "K.mtx", "%%MatrixMarket matrix coordinate real symmetric\n"
    path.write_text(heading + "1000000000000 1000000000000 1\n1 1 2.0\n")
    assert "1000000000000 rows" in refused(read_matrix, path, "K")
    monkeypatch.setenv("FAYING_MEMORY", "1e9")
    path.write_text(heading + "3 3 100000000000\n1 1 2.0\n")
    assert "its reader asked for more than 2 GB" in refused(read_matrix, path, "K")
    path.write_text(heading.replace("real", "complex") + "3 3 1\n1 1 2.0 0.0\n")
    assert "it is complex symmetric" in refused(read_matrix, path, "K")


DECKS = {
    "deck.bdf": (read_source, "BEGIN BULK\nINCLUDE '{}'\n"),
    "deck.inp": (lambda path: read_lines(path, DIALECT), "*INCLUDE, INPUT={}\n"),
}


@pytest.fixture(params=DECKS)
def deck(request, tmp_path):
    """A function that includes a file in a deck and returns what the reader says."""
    read, text = DECKS[request.param]

    def including(name):
        (tmp_path / request.param).write_text(text.format(name))
        return refused(read, tmp_path / request.param)

    return including


@pytest.mark.skipif(not Path("/dev/zero").exists(), reason="a device of Unix")
def test_devices_and_pipes_are_not_read(deck, tmp_path):
    os.mkfifo(tmp_path / "pipe")
    for name in ("/dev/zero", "pipe", "/dev/stdin", "."):
        assert "not a file" in deck(name)
    for path in (Path("/dev/zero"), tmp_path / "pipe"):
        assert "not a file" in refused(read_study, path)
        assert "not a file" in refused(fy.read_nastran, path)


def test_includes_of_themselves_and_of_nothing(deck, tmp_path):
    for name in ("deck.bdf", "deck.inp"):
        (tmp_path / name).write_text("")
    assert "not exist" in deck("other")
    assert "cannot be read" in deck("x" * 5000)
    (tmp_path / "link").symlink_to("link")
    assert "cannot be read" in deck("link")


@pytest.mark.long
def test_includes_that_multiply(tmp_path, monkeypatch):
    """Eleven files of two lines each stand for two thousand."""
    for suffix, (read, text) in {Path(name).suffix: deck for name, deck in DECKS.items()}.items():
        for number in range(11):
            line = text.splitlines()[-1].format(f"{number + 1}{suffix}") + "\n"
            (tmp_path / f"{number}{suffix}").write_text(2 * line)
        (tmp_path / f"11{suffix}").write_text("$ or * the end\n")
        assert "more than 1000 files" in refused(read, tmp_path / f"0{suffix}")
        monkeypatch.setenv("FAYING_MEMORY", "1000")
        assert "of memory are free" in refused(read, tmp_path / f"0{suffix}")
        monkeypatch.delenv("FAYING_MEMORY")


def test_files_larger_than_the_memory(tmp_path, monkeypatch):
    """Files with holes: a terabyte that takes no room."""
    monkeypatch.setenv("FAYING_MEMORY", "16e9")
    for name in ("K.mtx", "K.op4", "K.mat", "K.dmig", "K.sti", "study.toml", "nodes.csv"):
        with (tmp_path / name).open("wb") as file:
            if name == "K.mtx":
                file.write(b"%%MatrixMarket matrix array real general\n")
            file.truncate(10**12)
        read = {"study.toml": read_study, "nodes.csv": read_node_table}.get(
            name, lambda path: read_matrix(path, "K")
        )
        assert "1000 GB" in refused(read, tmp_path / name)
    monkeypatch.delenv("FAYING_MEMORY")


def test_readers_of_others_take_no_more_than_there_is(tmp_path, monkeypatch):
    monkeypatch.setenv("FAYING_MEMORY", "1e6")
    path = tmp_path / "joint.cdb"
    path.write_text("/PREP7\n")
    script = "import numpy as np, sys\nnp.savez(sys.argv[2], a=np.ones(int(2e8))[:1])"
    said = refused(lambda file: read_isolated(script, file, "archive", "ansys"), path)
    assert "its reader asked for more than 1 GB" in said


def test_counts_without_what_they_count(tmp_path):
    path = tmp_path / "mesh.msh"
    counted = "$Nodes\n1 99999999999999 1 99999999999999\n3 1 0 99999999999999\n$EndNodes\n"
    path.write_text(f"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n{counted}")
    said = refused(lambda file: read_mesh_file(file, materials={}), path)
    assert "a size in it asks for more memory than there is" in said


@pytest.mark.parametrize("order", ["C", "F"])
def test_zeros_of_a_full_matrix_take_no_memory(tmp_path, order):
    full = np.zeros((4000, 3000), order=order)  # 96 MB
    full[3999, 7], full[0, 2999] = 5.0, -2.0
    np.savez_compressed(tmp_path / "K.npz", K=full)
    del full
    tracemalloc.start()
    found = read_matrices(tmp_path / "K.npz")["K"]
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert found.nnz == 2
    assert (found[3999, 7], found[0, 2999]) == (5.0, -2.0)
    # A piece of 4 MB, and what NumPy and zlib hold of it besides.
    assert peak < 20e6
