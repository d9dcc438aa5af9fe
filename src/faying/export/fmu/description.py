"""Model descriptions of FMI 2.0 and FMI 3.0 as XML."""

from collections.abc import Sequence
from dataclasses import dataclass
from xml.etree import ElementTree as ET

import faying
from faying.export.fmu.variable import Kind, Unit, Variable

TYPES_2 = {"real": "Real", "integer": "Integer", "boolean": "Boolean"}
TYPES_3 = {"real": "Float64", "integer": "Int32", "boolean": "Boolean"}
DEFAULT_STEPS = 1000
"""Default number of steps of a simulation."""

LOG_CATEGORY = ("logStatusError", "errors; always logged")


@dataclass(frozen=True, eq=False, kw_only=True)
class Description:
    """The contents of a model description.

    Attributes
    ----------
    identifier
        Name of the shared library, and prefix of functions in source code.
    token
        GUID of FMI 2.0, instantiation token of FMI 3.0.
    units
        Units by quantity.
    step_size : [s]
        Suggested communication step.
    """

    title: str
    text: str
    identifier: str
    token: str
    variables: Sequence[Variable]
    units: dict[str, Unit]
    step_size: float


def fmi2_description(description: Description) -> bytes:
    """Return ``modelDescription.xml`` of FMI 2.0."""
    root, kind = _document(
        description,
        {"fmiVersion": "2.0", "guid": description.token, "numberOfEventIndicators": "0"},
        "canInterpolateInputs",
        "canNotUseMemoryManagementFunctions",
        "canGetAndSetFMUstate",
        "canSerializeFMUstate",
    )
    ET.SubElement(ET.SubElement(kind, "SourceFiles"), "File", name="fmi2.c")
    variables = ET.SubElement(root, "ModelVariables")
    for variable in description.variables:
        entry = ET.SubElement(variables, "ScalarVariable", _meaning(variable))
        ET.SubElement(entry, TYPES_2[variable.type], _value(variable, description))
    structure = ET.SubElement(root, "ModelStructure")
    for name in ("Outputs", "InitialUnknowns"):
        section = ET.SubElement(structure, name)
        for number, variable in enumerate(description.variables, start=1):
            if variable.causality == "output":
                ET.SubElement(section, "Unknown", index=str(number))
    return _text(root)


def fmi3_description(description: Description) -> bytes:
    """Return ``modelDescription.xml`` of FMI 3.0."""
    root, _ = _document(
        description,
        {"fmiVersion": "3.0", "instantiationToken": description.token},
        "canGetAndSetFMUState",
        "canSerializeFMUState",
    )
    variables = ET.SubElement(root, "ModelVariables")
    time = {
        "name": "time",
        "valueReference": str(int(Kind.TIME)),
        "causality": "independent",
        "variability": "continuous",
        "unit": "s",
        "description": "simulation time",
    }
    ET.SubElement(variables, "Float64", time)
    for variable in description.variables:
        attributes = _meaning(variable) | _value(variable, description)
        entry = ET.SubElement(variables, TYPES_3[variable.type], attributes)
        if variable.size is not None:
            ET.SubElement(entry, "Dimension", start=str(variable.size))
    structure = ET.SubElement(root, "ModelStructure")
    for name in ("Output", "InitialUnknown"):
        for variable in description.variables:
            if variable.causality == "output":
                ET.SubElement(structure, name, valueReference=str(variable.reference))
    return _text(root)


def build_description(description: Description) -> bytes:
    """Return ``sources/buildDescription.xml`` of FMI 3.0."""
    root = ET.Element("fmiBuildDescription", fmiVersion="3.0")
    build = ET.SubElement(root, "BuildConfiguration", modelIdentifier=description.identifier)
    files = ET.SubElement(build, "SourceFileSet", language="C99")
    ET.SubElement(files, "SourceFile", name="fmi3.c")
    ET.SubElement(build, "Library", name="m")
    return _text(root)


def _document(
    description: Description, version: dict[str, str], *abilities: str
) -> tuple[ET.Element, ET.Element]:
    """Return the root of a description without variables, and its co-simulation element."""
    common = {
        "modelName": description.title,
        "description": description.text,
        "generationTool": f"faying {faying.__version__}",
        "variableNamingConvention": "flat",
    }
    root = ET.Element("fmiModelDescription", common | version)
    able = dict.fromkeys(("canHandleVariableCommunicationStepSize", *abilities), "true")
    kind = ET.SubElement(root, "CoSimulation", able, modelIdentifier=description.identifier)
    _add_units(root, description)
    name, text = LOG_CATEGORY
    section = ET.SubElement(root, "LogCategories")
    ET.SubElement(section, "Category", name=name, description=text)
    ET.SubElement(
        root,
        "DefaultExperiment",
        startTime="0.0",
        stopTime=f"{DEFAULT_STEPS * description.step_size:.12g}",
        stepSize=repr(description.step_size),
    )
    return root, kind


def _meaning(variable: Variable) -> dict[str, str]:
    meaning = {
        "name": variable.name,
        "valueReference": str(variable.reference),
        "causality": variable.causality,
        "variability": variable.variability,
        "description": variable.description,
    }
    # FMI forbids 'initial' for inputs.
    if variable.causality != "input":
        meaning["initial"] = "exact" if variable.start is not None else "calculated"
    return meaning


def _value(variable: Variable, description: Description) -> dict[str, str]:
    value: dict[str, str] = {}
    if variable.quantity:
        value["unit"] = description.units[variable.quantity].name
    for name, limit in zip(("min", "max"), variable.limits, strict=True):
        if limit is not None:
            value[name] = _number(variable, limit)
    if variable.start is not None:
        value["start"] = _number(variable, variable.start)
    return value


def _number(variable: Variable, value: float) -> str:
    if variable.type == "boolean":
        return "true" if value else "false"
    return str(int(value)) if variable.type == "integer" else repr(float(value))


def _add_units(root: ET.Element, description: Description) -> None:
    section = ET.SubElement(root, "UnitDefinitions")
    used = {variable.quantity for variable in description.variables if variable.quantity} | {"time"}
    named = {
        description.units[quantity].name: description.units[quantity] for quantity in sorted(used)
    }
    for unit in named.values():
        entry = ET.SubElement(section, "Unit", name=unit.name)
        if unit.factor is not None:
            powers = zip(("kg", "m", "s", "rad"), unit.exponents, strict=True)
            base = {name: str(power) for name, power in powers if power}
            ET.SubElement(entry, "BaseUnit", base, factor=repr(unit.factor))


def _text(root: ET.Element) -> bytes:
    ET.indent(root)
    text: bytes = ET.tostring(root, encoding="UTF-8", xml_declaration=True)
    return text
