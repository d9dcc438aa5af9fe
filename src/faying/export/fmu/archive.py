"""The FMU files: description, sources, binary and resources in one archive each."""

import re
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from faying.export.fmu.description import (
    Description,
    build_description,
    fmi2_description,
    fmi3_description,
)
from faying.export.fmu.library import compile_library, platform_folder, suffix
from faying.export.fmu.resources import joint_file, recovery_file
from faying.export.fmu.variable import fmu_units, seconds
from faying.export.fmu.variables import variables
from faying.export.linearized import linearize
from faying.reduction.reduced_model import ReducedModel
from faying.study.keys.tables import DEFAULT_INSTANTS
from faying.study.results.values import Results

SOURCES = Path(__file__).parent / "sources"
EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of all members, so that equal joints give equal archives."""


def write(rom: ReducedModel, path: Path, run: Results | None = None) -> tuple[Path, ...]:
    """Write an FMU for FMI 2.0 and one for FMI 3.0, which contain the contact of the joint.

    The second is called ``NAME_fmi3.fmu``. The first transient of the run gives the time step.

    Raises
    ------
    ModelError
        If two variables would have the same name.
    StudyError
        If the interfaces are too large.

    Notes
    -----
    It contains sources, and a binary if this system has a C compiler, which takes some seconds.
    """
    step_size = _step_size(rom, run)
    joint, token = joint_file(rom, step_size)
    common = Description(
        title=rom.name,
        text=f"bolted joint with contact, reduced by {rom.method}",
        identifier=_identifier(path.stem),
        token=token,
        variables=variables(rom, step_size, arrays=False),
        units=fmu_units(rom.units),
        step_size=step_size,
    )
    arrays = replace(common, variables=variables(rom, step_size, arrays=True))
    resources = {
        "resources/joint.bin": joint,
        "resources/recovery.npz": recovery_file(rom),
        "resources/README.txt": (Path(__file__).parent / "resources.txt").read_bytes(),
    }
    second = path.with_name(f"{path.stem}_fmi3{path.suffix}")
    _pack(path, _members(common, 2) | resources)
    _pack(second, _members(arrays, 3) | resources)
    return path, second


def _members(description: Description, version: int) -> dict[str, bytes]:
    """Return description, sources and library of an FMI version, by path in the archive."""
    files = sorted(path for path in SOURCES.glob("*.c") if path.name != f"fmi{5 - version}.c")
    sources = {f"sources/{path.name}": path.read_bytes() for path in files}
    if version == 2:
        # A source distribution must name its functions after the model.
        prefix = f"#define FMI2_FUNCTION_PREFIX {description.identifier}_\n"
        sources["sources/identifier.h"] = prefix.encode()
        text = fmi2_description(description)
    else:
        sources["sources/buildDescription.xml"] = build_description(description)
        text = fmi3_description(description)
    return {"modelDescription.xml": text, **sources, **_binary(description, sources, version)}


def _binary(
    description: Description, sources: Mapping[str, bytes], version: int
) -> dict[str, bytes]:
    """Return the shared library by path; empty where it could not be compiled."""
    name = f"{description.identifier}{suffix()}"
    with tempfile.TemporaryDirectory() as folder:
        for source, text in sources.items():
            (Path(folder) / Path(source).name).write_bytes(text)
        library = Path(folder) / name
        if not compile_library(Path(folder) / f"fmi{version}.c", library):
            return {}
        return {f"binaries/{platform_folder(version)}/{name}": library.read_bytes()}


def _pack(path: Path, members: Mapping[str, bytes]) -> None:
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in members.items():
            entry = zipfile.ZipInfo(name, date_time=EPOCH)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, content)


def _identifier(stem: str) -> str:
    """Return a file stem as a C identifier."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", stem)
    return plain if re.match(r"[A-Za-z]", plain) else f"joint_{plain}"


def _step_size(rom: ReducedModel, run: Results | None) -> float:
    """Return the time step [s] of the run's first transient, or a part of the longest period."""
    cases = () if run is None else run.cases.values()
    for case in cases:
        if case.times is not None and len(case.times) > 1:
            return float(case.times[1] - case.times[0]) * seconds(rom.units)
    lowest = float(linearize(rom).frequencies(1)[0]) / seconds(rom.units)
    return float(np.format_float_scientific(1 / (DEFAULT_INSTANTS * lowest), precision=0))
