"""The export formats of reduced models, and the function that writes them.

A format is a module with ``write(rom: ReducedModel, path: Path, run: Results | None) -> tuple[Path,
...]``: it writes the file ``path``, or files named after it beside it, and returns them all,
the main file first; ``run`` is the run of the model, if
any. Modules are imported when their format is used.

Two classes exist. A *contact-capable* export has gap operator, law and residual compliance,
so that the receiving program opens and closes the joint itself. A *linear* export is the joint
linearized at its preloaded state (:mod:`faying.export.linearized`).
"""

import re
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import cast

from faying.exceptions import StudyError, refuse, refuse_study
from faying.files.atomic import move_into_place, writing
from faying.files.names import file_names
from faying.reduction.model_reader import read_reduced_model
from faying.reduction.reduced_model import ReducedModel
from faying.study.keys.errors import nearest
from faying.study.results.values import Results
from faying.study.stages.recover import reduced_model, results_of

DEFAULT_METHOD = "compliance"

LINEAR = "linear hand-over"
CONTACT = "contact-capable hand-over"
PICTURES = "pictures"
CURVES = "curves"

MEANINGS = {
    LINEAR: "the joint linearized at its preloaded state; it neither opens nor closes",
    CONTACT: "the receiving program opens and closes the joint",
    PICTURES: "fields for viewers; no model is exported",
    CURVES: "responses to harmonic loads; no model is exported",
}
"""Description of each class of exports."""

RUBS = "carried"
STICKS = "every closed point sticks"


@dataclass(frozen=True, kw_only=True)
class Format:
    """An export format.

    Attributes
    ----------
    module
        Module with its function ``write``.
    kind
        ``LINEAR``, ``CONTACT``, ``PICTURES`` or ``CURVES``.
    suffix
        Suffix of the file; empty for a folder.
    extra
        Extra of faying with the required packages; empty without any.
    friction
        Treatment of friction: ``RUBS``, ``STICKS``, or empty if joints with friction are refused.
    """

    module: str
    kind: str
    suffix: str
    extra: str = ""
    friction: str = ""


FORMATS = {
    "nastran": Format(module="faying.export.nastran", kind=LINEAR, suffix=".op4", friction=STICKS),
    "mat": Format(module="faying.export.matlab", kind=CONTACT, suffix=".mat", friction=RUBS),
    "fmu": Format(module="faying.export.fmu", kind=CONTACT, suffix=".fmu", friction=RUBS),
    "exudyn": Format(module="faying.export.exudyn", kind=CONTACT, suffix=".py", extra="exudyn"),
    "vtk": Format(module="faying.export.vtk", kind=PICTURES, suffix=""),
    "npz": Format(module="faying.export.arrays", kind=CONTACT, suffix=".npz", friction=RUBS),
    "uff": Format(
        module="faying.export.uff", kind=CURVES, suffix=".uff", extra="uff", friction=RUBS
    ),
}
"""Formats by name."""


def export(
    source: ReducedModel | Results | Path | str,
    to: str,
    *,
    out: Path | str | None = None,
    method: str | None = None,
    joint_modes: int | None = None,
) -> tuple[Path, ...]:
    """Write a reduced model in the format of another program.

    Parameters
    ----------
    source
        A reduced model, or its file; or a finished run, as its folder or its results.
    to
        Name of a format: nastran, mat, fmu, exudyn, vtk, npz, uff.
    out
        File to write; a missing suffix is added. By default it is named after the
        model, in the folder of the run.
    method, joint_modes
        Reduced model of a run; by default ``"compliance"``, and its largest number of joint modes.

    Returns
    -------
    tuple of Path
        All written files. They appear once all are complete, and replace older ones.

    Raises
    ------
    StudyError
        If the format or model does not exist, a required package is not installed, or the format
        does not support the friction or the contact law of the joint.
    FormatError
        If the run cannot be read or the files cannot be written.
    """
    chosen = format_named(to)
    rom, run, folder = _given(source, method, joint_modes)
    # Formats that carry friction know no other laws either: without the law all else follows.
    if chosen.kind == CONTACT:
        _check_laws(rom, to)
    _check_friction(rom, to, chosen)
    if out is None and folder is None:
        refuse_study(f"the {to} file has no path; give out=")
    target = (folder or Path()) / default_name(rom, to) if out is None else Path(out)
    if target.is_dir() and chosen.suffix:
        refuse(f"{target} is a folder; give a file, such as {target / default_name(rom, to)}")
    named = target if target.suffix else target.with_name(target.name + chosen.suffix)
    return _write(rom, run, to, chosen, named)


def run_model(
    run: Results, method: str | None = None, joint_modes: int | None = None
) -> ReducedModel:
    """Return a reduced model of a run, by default the one to export.

    Raises
    ------
    StudyError
        If the run has no such model.
    """
    name = DEFAULT_METHOD if method is None else method
    if joint_modes is None:
        joint_modes = max(run.reduced.get(name, ()), default=None)
    return reduced_model(run, name, joint_modes)


def _given(
    source: ReducedModel | Results | Path | str, method: str | None, joint_modes: int | None
) -> tuple[ReducedModel, Results | None, Path | None]:
    """Return the model, its run if any, and the folder to write to if known."""
    if isinstance(source, ReducedModel):
        return source, None, None
    if isinstance(source, Results):
        return run_model(source, method, joint_modes), source, None
    if Path(source).is_file():
        return read_reduced_model(source), None, Path(source).parent
    run = results_of(source)
    return run_model(run, method, joint_modes), run, Path(source)


def format_named(name: str) -> Format:
    """Return a format by name."""
    if name not in FORMATS:
        refuse_study(f"there is no export format '{name}'; {nearest(name, FORMATS)}")
    return FORMATS[name]


def default_name(rom: ReducedModel, to: str) -> str:
    """Return the default file name of a model in a format."""
    if FORMATS[to].kind == CURVES:
        return f"frf{FORMATS[to].suffix}"
    label = f"{rom.method}-{rom.joint_modes}" if rom.joint_modes else rom.method
    stem, suffix = file_names([label])[label], FORMATS[to].suffix
    if suffix == ".py":  # modules need an importable name
        return re.sub(r"\W", "_", f"{stem}_{to}") + suffix
    return f"{stem}{suffix}" if suffix else f"{stem}-{to}"


def _check_friction(rom: ReducedModel, to: str, chosen: Format) -> None:
    rubbing = rom.contact.rubbing_interfaces
    if rubbing and not chosen.friction:
        whole, linear = (
            ", ".join(name for name, e in FORMATS.items() if (e.kind, e.friction) == hand_over)
            for hand_over in ((CONTACT, RUBS), (LINEAR, STICKS))
        )
        refuse_study(
            f"interface '{rubbing[0]}' has friction, which {to} does not support; export the "
            f"joint with it ({whole}), the linear joint ({linear}), in which every closed point "
            "sticks, or the joint without friction (model.with_friction(0), or a study without "
            "'friction')"
        )


def _check_laws(rom: ReducedModel, to: str) -> None:
    """Refuse contact laws without parameters in the formats."""
    for name, law in rom.contact.laws.items():
        if not law.proportional:
            refuse_study(
                f"interface '{name}' has the law '{law.normal.name}', which {to} does not "
                "support; export the linear joint (nastran), or the joint with a penalty "
                "(model.with_penalty, or 'penalty' in a study)"
            )


def _write(
    rom: ReducedModel, run: Results | None, to: str, chosen: Format, path: Path
) -> tuple[Path, ...]:
    """Write to a temporary folder, then move the files, so that a failure keeps older files."""
    with writing(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as aside:
            staging = Path(aside)
            files = _written(rom, run, to, chosen, staging / path.name)
            return tuple(_moved(file, path.parent / file.relative_to(staging)) for file in files)


def _written(
    rom: ReducedModel, run: Results | None, to: str, chosen: Format, path: Path
) -> Sequence[Path]:
    try:
        module = import_module(chosen.module)
        return cast("tuple[Path, ...]", module.write(rom, path, run))
    except ModuleNotFoundError as error:
        remedy = (
            f"pip install 'faying[{chosen.extra}]'" if chosen.extra else f"pip install {error.name}"
        )
        message = f"export to {to} needs '{error.name}', which is not installed; {remedy}"
        raise StudyError(message) from None


def _moved(file: Path, target: Path) -> Path:
    target.parent.mkdir(parents=True, exist_ok=True)
    return move_into_place(file, target)
