"""The tables of a study file that describe the model: source, materials, interfaces, bolts."""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field, ValidationInfo

from faying.assessment.strength.grades import check_grade
from faying.assessment.strength.sizes import size_named
from faying.contact.laws import CLOSURES, Curve
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import FormatError, ModelError
from faying.interface.closure_table import COLUMNS, read_closure_table
from faying.io.left_out import IGNORABLE
from faying.sources import SOURCES
from faying.study.keys.errors import nearest, one_of, refusal, shown
from faying.study.keys.section import (
    Count,
    ExistingFile,
    Id,
    IdOrName,
    Ids,
    InitialGap,
    Name,
    NotNegative,
    Number,
    Penalty,
    Point,
    Positive,
    Section,
    Selection,
    Switch,
    TangentialPenalty,
    existing_file,
    name_in,
)
from faying.study.keys.topographies import CrownSection, TopographySection


def _closure(value: Any, info: ValidationInfo) -> Curve:
    """Return the closure of a study, from a csv file or from parameters."""
    if isinstance(value, Curve):
        return value
    if not isinstance(value, Mapping) or len(value) != 1:
        choices = ", ".join(f"{{ {_example(name)} }}" for name in CLOSURES)
        message = f"found {shown(value)}, expected one of {choices}"
        raise refusal(message)
    ((name, parameters),) = value.items()
    if name not in CLOSURES:
        raise refusal(one_of(name, list(CLOSURES)))
    try:
        if name in COLUMNS and isinstance(parameters, (str, Path)):
            return read_closure_table(existing_file(Path(parameters), info), name)
        return CLOSURES[name](**_parameters(name, parameters))
    except (ModelError, FormatError) as error:
        raise refusal(str(error)) from None


def _parameters(name: str, values: Any) -> dict[str, Any]:
    """Return the checked parameters of a closure by name."""
    if not isinstance(values, Mapping):
        message = f"found {shown(values)}, expected {_example(name)}"
        raise refusal(message)
    names = [entry.name for entry in fields(CLOSURES[name])]  # type: ignore[arg-type]
    for key in values:
        if key not in names:
            message = f"closure '{name}' has no '{key}'; {nearest(key, names)}"
            raise refusal(message)
    missing = [key for key in names if key not in values]
    if missing:
        message = f"closure '{name}' needs '{missing[0]}'; give {_example(name)}"
        raise refusal(message)
    for key, number in values.items():
        for entry in number if isinstance(number, (list, tuple)) else [number]:
            if isinstance(entry, bool) or not isinstance(entry, (int, float)):
                message = f"{key} of closure '{name}' is {shown(entry)}; give a number"
                raise refusal(message)
    return {key: values[key] for key in names}


def _example(name: str) -> str:
    if name in COLUMNS:
        return f'{name} = "file.csv"'
    names = ", ".join(f"{parameter.name} = …" for parameter in fields(CLOSURES[name]))  # type: ignore[arg-type]
    return f"{name} = {{ {names} }}"


Closure = Annotated[
    Any,
    BeforeValidator(
        _closure,
        json_schema_input_type=dict[Literal[tuple(CLOSURES)], str | dict[str, Number]],  # type: ignore[misc]
    ),
]


DisplacementComponent = Literal["ux", "uy", "uz", "rx", "ry", "rz"]


class MatrixFiles(Section):
    """[model.files]: what :func:`faying.io.matrices.read_matrices` reads.

    Matrices may be constrained, without rows of held or dependent degrees of freedom; or ``held``
    lists the rows to hold.
    """

    K: ExistingFile
    M: ExistingFile
    C: ExistingFile | None = None
    nodes: ExistingFile
    dofs: ExistingFile | None = None
    faces: ExistingFile | None = None
    node_sets: ExistingFile | None = None
    held: ExistingFile | None = None


def _named_set(value: Any) -> Any:
    """Return the short forms of a set with their keys."""
    if isinstance(value, str):
        return {"deck": value}
    if isinstance(value, int) and not isinstance(value, bool):
        return {"properties": [value]}
    if isinstance(value, list):
        return {"ids": value}
    if isinstance(value, dict):
        return value
    message = f"found {shown(value)}, expected a deck set's name, a property id, or a list of ids"
    raise refusal(message)


class NamedSet(Section):
    """[model.sets] NAME = { one of the keys below }."""

    one_of = ("deck", "properties", "ids", "nodes", "elements")
    deck: Name | None = None
    properties: Ids | None = None
    ids: Ids | None = None
    nodes: Ids | None = None
    elements: Ids | None = None


AnySet = Annotated[
    NamedSet, BeforeValidator(_named_set, json_schema_input_type=NamedSet | str | int | Ids)
]


class ModelSection(Section):
    """[model]: the source of the structure."""

    source: Annotated[str, name_in(SOURCES)]
    file: ExistingFile | None = None
    subcase: Count | None = None
    ignore: tuple[Annotated[str, name_in(IGNORABLE)], ...] = ()
    parts: tuple[IdOrName, ...] = ()
    without: tuple[IdOrName, ...] = ()
    files: MatrixFiles | None = None
    element: Literal["incompatible", "standard"] = "incompatible"
    separate: tuple[Name, ...] = ()
    sets: Mapping[str, AnySet] = Field(default_factory=dict)
    weak_springs: Positive | Literal["auto"] | None = None
    dense_budget: Positive | None = None
    lap_joint: Mapping[str, Any] = Field(default_factory=dict)


class MaterialSection(Section):
    """[material.NAME]: constants that replace those of a material.

    E [force/length²], rho [mass/length³], alpha [1/temperature].
    """

    E: Positive | None = None
    nu: Annotated[Number, Field(gt=-1, lt=0.5)] | None = None
    rho: NotNegative | None = None
    alpha: Number | None = None


class TemperatureSection(Section):
    """[temperature.NAME]: see :class:`faying.model.temperature.Temperature`."""

    reference: Number
    uniform: Number | None = None
    parts: Mapping[str, Number] = Field(default_factory=dict)


class InterfaceSection(Section):
    """[[interface]]: see :class:`faying.model.specs.InterfaceSpec`."""

    alternatives = ((("penalty", "closure"), "the contact law"),)
    name: Name
    minus: Selection = "auto"
    plus: Selection = "auto"
    meshes: Literal["matching", "non-matching"] = "matching"
    quadrature: Literal["gauss", "nodal"] | None = None
    order: Count | None = None
    penalty: Penalty = "auto"
    closure: Closure | None = None
    friction: Annotated[NotNegative, Field(le=LARGEST_FRICTION)] = 0.0
    tangential_penalty: TangentialPenalty = "auto"
    tolerance: Positive | None = None
    search_distance: Positive | None = None
    initial_gap: InitialGap | None = None
    topography: tuple[TopographySection, ...] = ()
    crown: tuple[CrownSection, ...] = ()


def _size(name: str) -> str:
    try:
        size_named(name)
    except ModelError as error:
        raise refusal(str(error)) from None
    return name


def _grade(name: str) -> str:
    try:
        check_grade(name)
    except ModelError as error:
        raise refusal(str(error)) from None
    return name


Grade = Annotated[Name, AfterValidator(_grade)]


class StrengthSection(Section):
    """[[bolt]] strength: see :class:`faying.assessment.strength.grades.BoltStrength`."""

    proof: Positive
    yields: Positive = Field(alias="yield")
    ultimate: Positive


class ThreadSection(Section):
    """[[bolt]] thread: see :class:`faying.assessment.strength.thread.Thread`."""

    diameter: Positive
    pitch: Positive
    grade: Grade
    friction: NotNegative | None = None
    head_diameter: Positive | None = None


class BoltSection(Section):
    """[[bolt]]: see :class:`faying.model.specs.BoltSpec`."""

    alternatives = (
        (("elements", "nodes", "axis"), "the place of the bolt"),
        (("preload", "torque", "utilisation", "initial_force"), "the tightening"),
        (("size", "thread"), "the thread"),
        (("gamma", "tightening_factor"), "the scatter of its preload"),
    )
    name: Name
    preload: NotNegative | None = None
    initial_force: NotNegative | None = None
    elements: Ids | None = None
    nodes: Annotated[tuple[Id, ...], Field(min_length=2)] | None = None
    stiffness: Positive | None = None
    direction: Point | None = None
    axis: tuple[Point, Point] | None = None
    diameter: Positive | None = None
    washer_radius: Positive | None = None
    washer: Literal["rbe2", "rbe3"] = "rbe2"
    material: IdOrName | None = None
    shear_flexible: Switch = True
    mass: Switch = True
    end_masses: tuple[NotNegative, NotNegative] = (0.0, 0.0)
    size: Annotated[Name, AfterValidator(_size)] | None = None
    head: Literal["ISO 4014", "ISO 4762", "ISO 7089"] = "ISO 4014"
    grade: Grade | None = None
    strength: StrengthSection | None = None
    torque: Positive | None = None
    utilisation: Annotated[Positive, Field(le=1)] | None = None
    thread_friction: NotNegative | None = None
    head_friction: NotNegative | None = None
    tightening_factor: Annotated[Number, Field(ge=1)] | None = None
    gamma: Annotated[NotNegative, Field(lt=1)] | None = None
    hole: Positive | None = None
    head_pressure_limit: Positive | None = None
    engagement: Positive | None = None
    thread: ThreadSection | None = None
    embedding: tuple[NotNegative, ...] = ()
    relaxation: Annotated[NotNegative, Field(lt=1)] = 0.0


class SupportSection(Section):
    """[[support]]: nodes held at zero, beside the supports of the source."""

    one_of = ("set", "node")
    set: Name | None = None
    node: Id | None = None
    components: Annotated[tuple[DisplacementComponent, ...], Field(min_length=1)] = (
        "ux",
        "uy",
        "uz",
    )


class MassSection(Section):
    """[[mass]]: a mass that moves with a node, or with the nodes of a set."""

    one_of = ("set", "node")
    name: Name | None = None
    set: Name | None = None
    node: Id | None = None
    mass: Positive


class BoundarySection(Section):
    """[[boundary]]: a place for loads, see :class:`faying.model.specs.BoundarySpec`."""

    alternatives = ((("set", "node"), "its nodes"),)
    name: Name
    set: Name | None = None
    node: Id | None = None
    coupling: Literal["rbe2", "rbe3"] | None = None
    at: Point | None = None


class StickingSection(Section):
    """[sticking]: pairs tied in tangential direction, seed §15.4.2."""

    threshold: Annotated[Number, Field(ge=0, le=1)] = 0.5
    stiffness: Positive


class DampingSection(Section):
    """[damping]: C = alpha M + beta K, alpha [1/time], beta [time]."""

    alpha: NotNegative = 0.0
    beta: NotNegative = 0.0
