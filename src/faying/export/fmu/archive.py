"""The FMU files: description, sources, binary, resources and documentation in one archive each."""

import re
import tempfile
import zipfile
from collections.abc import Mapping
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np

from faying.export.fmu.description import (
    Description,
    build_description,
    fmi2_description,
    fmi3_description,
)
from faying.export.fmu.library import compile_library, platform_folder, suffix
from faying.export.fmu.resources import joint_file, read_me, recovery_file
from faying.export.fmu.variable import Variable, fmu_units, seconds
from faying.export.fmu.variables import Defaults, scalars, with_arrays
from faying.export.linearized import linearize
from faying.reduction.reduced_model import ReducedModel
from faying.study.keys.tables import DEFAULT_INSTANTS
from faying.study.results.values import Results

SOURCES = Path(__file__).parent / "sources"
SHARED = (
    "linalg.c",
    "joint.c",
    "contact.c",
    "friction.c",
    "increments.c",
    "motion.c",
    "forces.c",
    "mean.c",
    "start.c",
    "steps.c",
    "variables.c",
    "fmi.c",
)

EPOCH = (1980, 1, 1, 0, 0, 0)
"""Date of all members: equal joints give equal archives."""


def write(rom: ReducedModel, path: Path, run: Results | None = None) -> tuple[Path, ...]:
    """Write an FMI 2.0 FMU, and beside it one of FMI 3.0, with the contact of the joint inside.

    The other one is called ``NAME_fmi3.fmu``. The first transient of the run says the time step.

    Raises
    ------
    ModelError
        If two variables would have the same name.
    StudyError
        If the interfaces are too large.

    Notes
    -----
    Sources always; a binary for this system if it has a C compiler, which takes some seconds.
    """
    defaults = Defaults(step_size=_step_size(rom, run))
    joint, token = joint_file(rom, defaults)
    common = Description(
        title=rom.name,
        text=f"bolted joint with contact, reduced by {rom.method}",
        identifier=_identifier(path.stem),
        token=token,
        variables=scalars(rom, defaults),
        units=fmu_units(rom.units),
        step_size=defaults.step_size,
    )
    arrays = replace(common, variables=with_arrays(rom, defaults))
    resources = {
        "resources/joint.bin": joint,
        "resources/recovery.npz": recovery_file(rom),
        "resources/README.txt": read_me().encode(),
    }
    second = path.with_name(f"{path.stem}_fmi3{path.suffix}")
    _pack(path, _fmi2(common) | resources)
    _pack(second, _fmi3(arrays) | resources)
    return path, second


def _fmi2(description: Description) -> dict[str, bytes]:
    sources = _sources("fmi2.c")
    # A source distribution must name its functions after the model.
    prefix = f"#define FMI2_FUNCTION_PREFIX {description.identifier}_\n"
    sources["sources/identifier.h"] = prefix.encode()
    return {
        "modelDescription.xml": fmi2_description(description),
        "documentation/index.html": _page(description, 2),
        **sources,
        **_binary(description, sources, 2),
    }


def _fmi3(description: Description) -> dict[str, bytes]:
    sources = _sources("fmi3.c")
    return {
        "modelDescription.xml": fmi3_description(description),
        "documentation/index.html": _page(description, 3),
        "sources/buildDescription.xml": build_description(description),
        **sources,
        **_binary(description, sources, 3),
    }


def _sources(main: str) -> dict[str, bytes]:
    return {f"sources/{name}": (SOURCES / name).read_bytes() for name in (*SHARED, main)}


def _binary(
    description: Description, sources: Mapping[str, bytes], version: int
) -> dict[str, bytes]:
    """Return the shared library, nothing where it could not be compiled."""
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
    """Return a C identifier."""
    plain = re.sub(r"[^A-Za-z0-9_]", "_", stem)
    return plain if re.match(r"[A-Za-z]", plain) else f"joint_{plain}"


def _step_size(rom: ReducedModel, run: Results | None) -> float:
    """Return the time step of the run's first transient, or a part of the lowest period [s]."""
    cases = () if run is None else run.cases.values()
    for case in cases:
        if case.times is not None and len(case.times) > 1:
            return float(case.times[1] - case.times[0]) * seconds(rom.units)
    lowest = float(linearize(rom).frequencies(1)[0]) / seconds(rom.units)
    return float(np.format_float_scientific(1 / (DEFAULT_INSTANTS * lowest), precision=0))


def _page(description: Description, version: int) -> bytes:
    """Return the documentation page: variables, and how to compile."""
    rows = "\n".join(_row(variable, description) for variable in description.variables)
    override = " -DFMI2_OVERRIDE_FUNCTION_PREFIX" if version == 2 else ""
    text = f"""<!DOCTYPE html>
<html lang="en"><meta charset="utf-8"><title>{escape(description.title)}</title>
<h1>{escape(description.title)}</h1>
<p>{escape(description.text)}. Inputs are held over a communication step, which is divided into
equal internal steps no longer than <code>step_size</code>.</p>
<p>To compile for another system, in the folder <code>sources</code>:</p>
<pre>cc -std=c99 -O3 -fPIC -shared{override} fmi{version}.c -o {description.identifier}.so -lm</pre>
<p>and put the library into <code>binaries/PLATFORM</code>.</p>
<table border="1">
<tr><th>variable<th>causality<th>unit<th>start<th>meaning</tr>
{rows}
</table>
</html>
"""
    return text.encode()


def _row(variable: Variable, description: Description) -> str:
    unit = description.units[variable.quantity].name if variable.quantity else ""
    start = "" if variable.start is None else f"{variable.start:g}"
    size = "" if variable.size is None else f" [{variable.size}]"
    cells = (variable.name + size, variable.causality, unit, start, variable.description)
    return "<tr>" + "".join(f"<td>{escape(cell)}" for cell in cells) + "</tr>"
