"""The tables of a study file that describe the model: source, materials, interfaces, bolts."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, BeforeValidator, Field

from faying.assessment.strength.grades import check_grade
from faying.assessment.strength.sizes import size_named
from faying.contact.laws.coulomb import LARGEST_FRICTION
from faying.exceptions import ModelError
from faying.io.left_out import IGNORABLE
from faying.sources import SOURCES
from faying.study.keys.closure import Closure
from faying.study.keys.errors import refusal, shown
from faying.study.keys.section import (
    Count,
    ExistingFile,
    Id,
    IdOrName,
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
    name_in,
)
from faying.study.keys.topographies import CrownSection, TopographySection

DisplacementComponent = Literal["ux", "uy", "uz", "rx", "ry", "rz"]


class MatrixFiles(Section):
    """[model.files]: what :func:`faying.io.matrices.read_matrices` reads.

    Matrices may come constrained, without rows for what is held or depends on others; or ``held``
    names the rows to hold.
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
    """Give the short forms of a set their keys."""
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


IdList = Annotated[tuple[Id, ...], Field(min_length=1)]


class NamedSet(Section):
    """[model.sets] NAME = { one of the keys below }.

    Attributes
    ----------
    deck
        Name of a set of the deck; NAME = "deck name" for short.
    properties
        Elements of these properties; NAME = id for short.
    ids
        Node ids where a boundary uses the name, element ids where an interface does;
        NAME = [id, …] for short.
    nodes, elements
        Ids, whoever uses the name.
    """

    deck: Name | None = None
    properties: IdList | None = None
    ids: IdList | None = None
    nodes: IdList | None = None
    elements: IdList | None = None


AnySet = Annotated[
    NamedSet, BeforeValidator(_named_set, json_schema_input_type=NamedSet | str | int | IdList)
]


class ModelSection(Section):
    """[model]: where the structure comes from.

    Attributes
    ----------
    file
        Deck of sources "nastran" and "abaqus", mesh file of source "mesh".
    subcase
        Subcase or step of the deck whose supports and loads count; the first unless given.
    ignore
        What the deck has and the model shall not, see :data:`faying.io.left_out.IGNORABLE`.
    parts
        Bodies, element sets or property ids that the model is made of; all unless given.
    without
        Bodies, element sets or property ids that are left out of it.
    files
        Matrix and table files of source "matrices".
    element
        Formulation of hex8.
    separate
        Volume groups of a mesh file that get nodes of their own where they touch others.
    sets
        Own names for parts of the mesh.
    weak_springs
        Hold bodies that contact alone would hold by springs of this stiffness [force/length].
    lap_joint
        Keywords of :func:`faying.joint.lap_joint.lap_joint_assembly`.
    """

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
    lap_joint: Mapping[str, Any] = Field(default_factory=dict)


class MaterialSection(Section):
    """[material.NAME]: values that replace those of the material of that name.

    Attributes
    ----------
    E : [force/length²]
    nu : [-]
    rho : [mass/length³]
    alpha : [1/temperature]
        Coefficient of thermal expansion.
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
    """[[interface]]: see :class:`faying.model.specs.InterfaceSpec`.

    Attributes
    ----------
    initial_gap : [length]
        Added to the gap of the geometry before anything is tightened: one offset everywhere, or a
        file for :func:`faying.interface.gap_field.read_gap_field`.
    topography
        Scans of one side, of both or of the gap, whose gap is added too.
    crown
        Crowned or hollow surfaces, whose gap is added too.
    """

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
    """[[bolt]]: see :class:`faying.model.specs.BoltSpec`.

    Attributes
    ----------
    nodes
        Instead of ``elements``: ids of the nodes that the bolt's beams of the deck run through.
        Of source "matrices": the nodes on the head's and on the nut's side.
    stiffness, direction
        Of source "matrices" only.
    preload : [force]
        Final axial force in the preloaded state.
    initial_force : [force]
        Instead of it: the force the bolt would have if nothing gave way, Young's modulus × area ×
        initial strain. The joint relaxes part of it.
    end_masses : [mass]
        Of a generated bolt: of head and washer where its axis begins, of nut and washer where it
        ends.
    size
        Name of its thread, as ``"M8"``, ``"M8x1"`` or ``"3/8-24 UNF"``.
    head
        Hexagon, socket, or hexagon on a plain washer.
    grade
        As ``"8.8"``, ``"A2-70"`` or ``"SAE 5"``.
    strength
        In place of that of the grade.
    torque : [force·length]
        Instead of ``preload``: M_A.
    utilisation
        Instead of both: the share of its yield stress to which tightening uses it.
    thread_friction, head_friction
        μ_G and μ_K.
    tightening_factor
        α_A, largest over smallest preload.
    gamma
        Instead: Γ, variation of the preload about the nominal one.
    hole : [length]
        Diameter of the hole under the head.
    head_pressure_limit : [force/length²]
        What the plate under head and nut bears.
    engagement : [length]
        Length of the thread that is engaged.
    thread
        Diameter, pitch and grade in numbers, in place of ``size`` and ``grade``.
    embedding : [length]
        What each face between head and nut flattens after tightening.
    relaxation
        Share of the force that is lost in time.
    """

    name: Name
    preload: NotNegative | None = None
    initial_force: NotNegative | None = None
    elements: Annotated[tuple[Id, ...], Field(min_length=1)] | None = None
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
    """[[support]]: nodes held at zero, beside what the source holds itself.

    Attributes
    ----------
    components
        Displacements ``ux`` … and rotations ``rx`` … that are held.
    """

    set: Name | None = None
    node: Id | None = None
    components: Annotated[tuple[DisplacementComponent, ...], Field(min_length=1)] = (
        "ux",
        "uy",
        "uz",
    )


class MassSection(Section):
    """[[mass]]: a mass that moves with a node, or with the nodes of a set.

    Attributes
    ----------
    name
        What it is of, for the reader.
    mass : [mass]
        In all; the nodes of a set share it evenly.
    """

    name: Name | None = None
    set: Name | None = None
    node: Id | None = None
    mass: Positive


class BoundarySection(Section):
    """[[boundary]]: where loads enter, see :class:`faying.model.specs.BoundarySpec`."""

    name: Name
    set: Name | None = None
    node: Id | None = None
    coupling: Literal["rbe2", "rbe3"] | None = None
    at: Point | None = None


class StickingSection(Section):
    """[sticking]: pairs tied in tangential direction, seed §15.4.2.

    Attributes
    ----------
    threshold
        Fraction of the preload's largest pressure above which a pair sticks.
    stiffness : [force/length]
        Of the tangential springs of one pair.
    """

    threshold: Annotated[Number, Field(ge=0, le=1)] = 0.5
    stiffness: Positive


class DampingSection(Section):
    """[damping]: C = alpha M + beta K, alpha [1/time], beta [time]."""

    alpha: NotNegative = 0.0
    beta: NotNegative = 0.0
