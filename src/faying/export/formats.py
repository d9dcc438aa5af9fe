"""Every format a reduced model can be handed over in, and the one function that writes any of them.

A format is a module with ``write(hand_over: HandOver, path: Path) -> tuple[Path, ...]``: it writes
the file ``path``, or files named after it beside it, and returns them all, ``path`` or what stands
in its place first. Modules are imported when their format is asked for.
"""

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import cast

from faying.exceptions import FormatError, StudyError
from faying.export.hand_over import HandOver, hand_over
from faying.files.atomic import moved
from faying.files.names import file_names
from faying.study.errors import nearest

LINEAR = "linear hand-over"
CONTACT = "contact-capable hand-over"
PICTURES = "pictures"

MEANINGS = {
    LINEAR: "the joint linearized at its preloaded state; it neither opens nor closes",
    CONTACT: "the receiving program opens and closes the joint",
    PICTURES: "to look at; no model is handed over",
}
"""What each class of hand-over can do."""


@dataclass(frozen=True, kw_only=True)
class Format:
    """A format of hand-over.

    Attributes
    ----------
    module
        Where its ``write`` is.
    kind
        ``LINEAR``, ``CONTACT`` or ``PICTURES``.
    suffix
        Of the file it writes; empty where that is a folder.
    extra
        Extra of faying that installs what it needs; empty where it needs nothing.
    """

    module: str
    kind: str
    suffix: str
    extra: str = ""


FORMATS = {
    "nastran": Format(module="faying.export.nastran", kind=LINEAR, suffix=".op4"),
    "mat": Format(module="faying.export.matlab", kind=CONTACT, suffix=".mat"),
    "fmu": Format(module="faying.export.fmu", kind=CONTACT, suffix=".fmu"),
    "exudyn": Format(module="faying.export.exudyn", kind=CONTACT, suffix=".py", extra="exudyn"),
    "vtk": Format(module="faying.export.vtk", kind=PICTURES, suffix=""),
    "npz": Format(module="faying.export.numpy_archive", kind=CONTACT, suffix=".npz"),
}
"""Format name to format."""


def export(
    source: HandOver | Path | str,
    to: str,
    *,
    out: Path | str | None = None,
    method: str | None = None,
    joint_modes: int | None = None,
) -> tuple[Path, ...]:
    """Hand a reduced model over to another program.

    Parameters
    ----------
    source
        Folder of a finished run; or a hand-over as :func:`~faying.export.hand_over.hand_over` and
        :func:`~faying.export.hand_over.hand_over_of` make it, ``method`` and ``joint_modes`` are
        then its own.
    to
        Name of a format: nastran, mat, fmu, exudyn, vtk, npz.
    out
        File to write; without suffix it gets that of the format. By default it is named after the
        model, in the folder of the run.
    method, joint_modes
        Which reduced model of the run; ``"compliance"``, and the most joint modes it has.

    Returns
    -------
    tuple of Path
        All files that were written. They appear once all are complete, and replace older ones.

    Raises
    ------
    StudyError
        If there is no such format or model, or what the format needs is not installed.
    FormatError
        If the run cannot be read or the files cannot be written.
    """
    chosen = format_named(to)
    given = source if isinstance(source, HandOver) else _read(Path(source), method, joint_modes)
    if out is None and isinstance(source, HandOver):
        message = f"nothing says where to write the {to} file; give out="
        raise StudyError(message)
    folder = Path() if isinstance(source, HandOver) else Path(source)
    target = folder / default_name(given, to) if out is None else Path(out)
    if target.is_dir() and chosen.suffix:
        message = f"{target} is a folder; name a file, such as {target / default_name(given, to)}"
        raise FormatError(message)
    return _write(given, to, chosen, _named(target, chosen))


def format_named(name: str) -> Format:
    """Return a format by name.

    Raises
    ------
    StudyError
        If there is none.
    """
    if name not in FORMATS:
        message = f"there is no export format '{name}'; {nearest(name, FORMATS)}"
        raise StudyError(message)
    return FORMATS[name]


def default_name(given: HandOver, to: str) -> str:
    """Return the file name a hand-over gets unless another is asked for."""
    label = f"{given.method}-{given.joint_modes}" if given.joint_modes else given.method
    stem, suffix = file_names([label])[label], FORMATS[to].suffix
    if suffix == ".py":  # a module must have a name that can be imported
        return re.sub(r"\W", "_", f"{stem}_{to}") + suffix
    return f"{stem}{suffix}" if suffix else f"{stem}-{to}"


def _read(folder: Path, method: str | None, joint_modes: int | None) -> HandOver:
    from faying.study.recover import results_of

    return hand_over(results_of(folder), method, joint_modes)


def _named(path: Path, chosen: Format) -> Path:
    return path if path.suffix else path.with_name(path.name + chosen.suffix)


def _write(given: HandOver, to: str, chosen: Format, path: Path) -> tuple[Path, ...]:
    """Write aside, then move: a failure on the way leaves what was there before."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as aside:
            staging = Path(aside)
            files = _written(given, to, chosen, staging / path.name)
            return tuple(_moved(file, path.parent / file.relative_to(staging)) for file in files)
    except OSError as error:
        message = f"cannot write {path}: {error.strerror}; check the folder and free space"
        raise FormatError(message) from None


def _written(given: HandOver, to: str, chosen: Format, path: Path) -> Sequence[Path]:
    try:
        module = import_module(chosen.module)
        return cast("tuple[Path, ...]", module.write(given, path))
    except ModuleNotFoundError as error:
        remedy = (
            f"pip install 'faying[{chosen.extra}]'" if chosen.extra else f"pip install {error.name}"
        )
        message = f"export to {to} needs '{error.name}', which is not installed; {remedy}"
        raise StudyError(message) from None


def _moved(file: Path, place: Path) -> Path:
    place.parent.mkdir(parents=True, exist_ok=True)
    return moved(file, place)
