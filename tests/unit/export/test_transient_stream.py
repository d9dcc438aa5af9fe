"""Long transients: written as they come, the same numbers, memory of one piece, resumable."""

import resource
import tracemalloc

import h5py
import numpy as np
import pytest

import faying as fy
from faying.exceptions import FormatError, ModelError
from faying.export import transient_stream
from faying.export.transient_stream import FIELDS, SLACK
from faying.simulation.compiled import import_loop

STEP = 1e-5


@pytest.fixture(scope="module")
def rom(joint, classic):
    return fy.reduce(joint, classic, compliance=True)


@pytest.fixture(scope="module")
def load():
    times = np.linspace(0, 0.01, 101)
    return fy.Load({"tip.Fz": fy.History(times, -500 * np.sin(2000 * times)), "tip.Mx": 5e3})


@pytest.fixture(autouse=True)
def short_pieces(monkeypatch):
    monkeypatch.setattr(transient_stream, "STEPS_AT_ONCE", 30)


def compare(path, solution, n_step):
    with h5py.File(path) as file:
        assert file.attrs["complete"]
        found = {
            "states": file["states"][()],
            "times": file["times"][()],
            "max_pressure": file["max_pressure"][()],
            "tip": file["displacements/tip"][()],
            "force": file["contact_forces/joint"][()],
            "bolt": file["bolt_forces/bolt"][()],
        }
    expected = {
        "states": solution.states,
        "times": solution.times,
        "max_pressure": solution.max_pressure,
        "tip": solution.displacement("tip"),
        "force": solution.contact_force("joint"),
        "bolt": solution.bolt_force("bolt"),
    }
    for name, values in expected.items():
        assert len(found[name]) == n_step + 1
        # the same arithmetic; contact blocks may be solved from other factorizations
        np.testing.assert_allclose(
            found[name], values, rtol=0, atol=1e-10 * np.abs(values).max(), err_msg=name
        )


@pytest.mark.parametrize("integrator", [None, fy.GeneralizedAlpha(0.8), fy.EnergyDecaying()])
def test_streamed_is_solved(rom, load, integrator, tmp_path):
    solution = fy.solve_transient(rom, load, step=STEP, duration=100 * STEP, integrator=integrator)
    path = fy.stream_transient(
        rom, load, tmp_path / "long.h5", step=STEP, duration=100 * STEP, integrator=integrator
    )
    compare(path, solution, 100)


def test_stopped_runs_keep_their_pieces_and_go_on(rom, load, tmp_path):
    path = tmp_path / "long.h5"

    steps = []

    def stop(done):
        steps.append(done)
        if sum(steps) > 70:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        fy.stream_transient(rom, load, path, step=STEP, duration=100 * STEP, progress=stop)
    with h5py.File(path) as file:
        assert not file.attrs["complete"]
        assert len(file["times"]) == 61  # two whole pieces and the start
    fy.stream_transient(rom, load, path, step=STEP, duration=100 * STEP, resume=True)
    compare(path, fy.solve_transient(rom, load, step=STEP, duration=100 * STEP), 100)
    # a finished run can be prolonged
    fy.stream_transient(rom, load, path, step=STEP, duration=130 * STEP, resume=True)
    compare(path, fy.solve_transient(rom, load, step=STEP, duration=130 * STEP), 130)


@pytest.mark.parametrize("begun", [8, 20, 21, 24, 28, 32, 36])
def test_stopped_at_any_write(rom, load, tmp_path, monkeypatch, begun):
    """A piece takes some eighteen writes; stopped in the second, the first is as it was."""
    write, writes = h5py.Dataset.__setitem__, iter(range(10_000))

    def stop(*arguments):
        if next(writes) == begun:
            raise KeyboardInterrupt
        write(*arguments)

    path = tmp_path / "long.h5"
    with monkeypatch.context() as stopping:
        stopping.setattr(h5py.Dataset, "__setitem__", stop)
        with pytest.raises(KeyboardInterrupt):
            fy.stream_transient(rom, load, path, step=STEP, duration=100 * STEP)
    fy.stream_transient(rom, load, path, step=STEP, duration=100 * STEP, resume=True)
    compare(path, fy.solve_transient(rom, load, step=STEP, duration=100 * STEP), 100)


@pytest.mark.parametrize("more", [-1_000_000, 10_000, 100_000, 150_000])
def test_full_disk(rom, load, tmp_path, monkeypatch, capfd, more):
    """Met before anything is written: one message, a file that can be read, and resumed."""
    import_loop()  # what numba compiles is kept in files too
    monkeypatch.setattr(transient_stream, "INSTANTS_PER_CHUNK", 30)
    path, fields = tmp_path / "long.h5", ("states", "pressure")
    usual = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (SLACK + more, usual[1]))
    options = {"step": STEP, "duration": 100 * STEP, "fields": fields}
    try:
        with pytest.raises(FormatError, match=r"cannot write .*long\.h5: File too l"):
            fy.stream_transient(rom, load, path, **options)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, usual)
    fy.stream_transient(rom, load, path, resume=True, **options)
    compare(path, fy.solve_transient(rom, load, step=STEP, duration=100 * STEP), 100)
    assert capfd.readouterr().err == ""  # HDF5 reports there


def test_space_that_was_reserved_is_given_back(rom, load, tmp_path):
    path = fy.stream_transient(rom, load, tmp_path / "long.h5", step=STEP, duration=10 * STEP)
    assert path.stat().st_size < SLACK


@pytest.mark.long
def test_memory_does_not_grow_with_the_history(rom, load, tmp_path):
    def peak(n_step):
        tracemalloc.start()
        fy.stream_transient(
            rom, load, tmp_path / "long.h5", step=STEP, duration=n_step * STEP, fields=()
        )
        _, highest = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        return highest

    peak(40)  # imports and caches
    # Five times the steps, which as a history would take five times as much; the factorizations
    # remembered are some more after 400 steps, but bounded.
    assert peak(2000) < 1.3 * peak(400)


def test_what_cannot_go_on_is_refused(rom, load, tmp_path):
    path = tmp_path / "long.h5"
    with pytest.raises(ModelError, match="no field 'stress'"):
        fy.stream_transient(rom, load, path, step=STEP, duration=STEP, fields=("stress",))
    fy.stream_transient(rom, load, path, step=STEP, duration=10 * STEP)
    with pytest.raises(FormatError, match="has step 1e-05, expected 2e-05"):
        fy.stream_transient(rom, load, path, step=2 * STEP, duration=20 * STEP, resume=True)
    with pytest.raises(FormatError, match="cannot write"):
        fy.stream_transient(rom, load, tmp_path / "no" / "a.h5", step=STEP, duration=STEP)


def _linked(file):
    file["elsewhere"] = h5py.ExternalLink("other.h5", "/")


def _without_a_motion(file):
    slot = str(file["restart"].attrs["slot"])
    del file["restart"][slot]["motion.v"]


def _announcing_more(file):
    place = file["restart"][str(file["restart"].attrs["slot"])]
    del place["contact.active"]
    place.create_dataset("contact.active", shape=(10**12,), chunks=(1024,), dtype=float)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (_linked, "damaged, or another program wrote it .'/elsewhere' is a link to another place"),
        (_without_a_motion, r"damaged, or another program wrote it .*v is missing"),
        (_announcing_more, "belongs to another model; start again without resume"),
    ],
)
def test_files_of_others_are_looked_through_before_they_are_gone_on_with(
    rom, load, tmp_path, change, said
):
    path = fy.stream_transient(rom, load, tmp_path / "long.h5", step=STEP, duration=10 * STEP)
    with h5py.File(path, "r+") as file:
        change(file)
    with pytest.raises(FormatError, match=said):
        fy.stream_transient(rom, load, path, step=STEP, duration=20 * STEP, resume=True)


def test_what_is_no_history_is_not_gone_on_with(rom, load, tmp_path):
    path = tmp_path / "notes.txt"
    path.write_text("nothing of ours")
    with pytest.raises(FormatError, match=r"not an HDF5 file.*a history of fy\.stream_transient"):
        fy.stream_transient(rom, load, path, step=STEP, duration=STEP, resume=True)
    assert path.read_text() == "nothing of ours"


def test_every_field_can_be_kept(rom, load, tmp_path):
    path = tmp_path / "all.h5"
    fy.stream_transient(rom, load, path, step=STEP, duration=5 * STEP, fields=tuple(FIELDS))
    with h5py.File(path) as file:
        assert {name: len(file[name]) for name in FIELDS} == dict.fromkeys(FIELDS, 6)
