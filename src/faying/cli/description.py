"""Tables of ``faying check``: how a study and its model were read."""

import json
from collections.abc import Iterable, Iterator

import numpy as np
from rich.table import Table

from faying.cli.load_rows import case_rows, frequency_rows
from faying.cli.tables import text_table
from faying.contact.laws import Penalty
from faying.display.facts import MOST_SHOWN, listed
from faying.interface.interface import Interface
from faying.joint.diagnosis import AS_A_WHOLE, FreeParts
from faying.joint.expected_memory import expected_memory
from faying.joint.model import Model
from faying.linalg.memory import FactorMemory, free_memory, gigabytes
from faying.model.assembly import Assembly
from faying.model.bodies import body_names
from faying.model.boundary import DISPLACEMENT_NAMES, FORCE_NAMES, Boundary
from faying.model.deck_bolt import bolt_direction
from faying.model.matrices import mass_properties
from faying.model.mesh import Mesh
from faying.model.specs import BoltSpec
from faying.study.inputs.load_model import LoadedModel
from faying.study.inputs.model_preview import ModelPreview
from faying.study.judgement.model_warnings import kept_share
from faying.study.keys.deck_study import is_bare, quoted
from faying.study.keys.tables import Study
from faying.study.keys.threads import StudyBolts


def described(study: Study, loaded: LoadedModel, preview: ModelPreview) -> Iterator[Table]:
    """Yield the tables of ``faying check``, in the order of the data flow."""
    model = preview.model
    yield _overview(study, model)
    yield _bodies(model.assembly.mesh)
    yield _materials(model.assembly)
    yield _connections(model.assembly)
    yield _rigid_body_modes(preview.free)
    if model.interfaces:
        yield _interfaces(model, "Interfaces" if loaded.interfaces else "Candidate interfaces")
        yield _sides(model)
        yield _friction(model)
    if model.bolts:
        yield _bolts(study, loaded, model)
    if model.boundaries:
        rows = map(_boundary, model.boundaries.values())
        yield text_table("Boundaries", ["name", "nodes", "loads it takes"], rows)
    if study.load_cases:
        yield text_table("Load cases", ["name", "kind", "loads", "time"], case_rows(study))
    if study.frequencies:
        columns = ["name", "loads", "levels", "frequencies"]
        yield text_table("Harmonic loads", columns, frequency_rows(study))
    if model.assembly.loads:
        yield _deck_loads(study, loaded)
        yield from _unused_loads(study, loaded)
    if model.assembly.ignored:
        yield text_table(
            "Notes on the source",
            ["left out or approximated"],
            ([text] for text in model.assembly.ignored),
        )
    yield from _missing(study, preview)


def _missing(study: Study, preview: ModelPreview) -> Iterator[Table]:
    """Yield tables of missing parts for a run, and of study lines to add."""
    if preview.needs:
        columns = ["missing for a run"]
        yield text_table("Not ready to run", columns, ([need] for need in preview.needs))
    lines = []
    if is_bare(study.path):
        lines += ["[model]", f'source = "{study.model.source}"']
        lines.append(f"file = {quoted(study.path.name)}")
        if study.model.ignore:
            lines.append(f"ignore = [{', '.join(map(quoted, study.model.ignore))}]")
        lines.append("")
    if preview.candidate is not None:
        lines += ["[[interface]]", f'name = "{preview.candidate.name}"']
        lines += ['minus = "auto"', 'plus = "auto"', f'meshes = "{preview.candidate.meshes}"', ""]
    if lines:
        title = f"A study begins like this ({study.path.stem}.toml)"
        yield text_table(
            title if is_bare(study.path) else "Add", ["TOML"], ([x] for x in lines[:-1])
        )


def _overview(study: Study, model: Model) -> Table:
    assembly = model.assembly
    weight = mass_properties(assembly)
    kinds = sorted({block.kind for block in assembly.mesh.blocks})
    formulation = f" ({assembly.element})" if "hex8" in kinds else ""
    # Round-off of a symmetric model is shown as zero.
    extent = np.ptp(assembly.mesh.nodes, axis=0).max()
    centre = np.where(np.abs(weight.centre) < 1e-9 * extent, 0.0, weight.centre)
    units = study.units.split("-")
    n_shell = sum(len(block.ids) for block in assembly.shells)
    rows = [
        ("source", study.model.source),
        ("units (length-mass-time)", study.units),
        ("nodes", len(assembly.mesh.nodes)),
        ("solid elements", f"{assembly.mesh.n_elements} {', '.join(kinds)}{formulation}"),
        ("beams", len(assembly.beams)),
        *([("shells", n_shell)] if n_shell else []),
        ("free degrees of freedom", model.structure.n_dof),
        ("factorization", _factorization(expected_memory(model))),
        (f"mass [{units[1]}]", weight.mass),
        (f"centre of mass [{units[0]}]", _point(centre.tolist())),
    ]
    return text_table(study.title or study.path.stem, ["model", ""], rows)


def _factorization(memory: FactorMemory) -> str:
    """Return the factorization library and its memory as text."""
    about = "" if memory.counted else ", within a factor of two"
    free = free_memory()
    there = "" if free is None else f"; {gigabytes(free)} are free"
    enough = free is None or memory.peak <= free
    return (
        f"{memory.backend}, {gigabytes(memory.factor)} of factors, {gigabytes(memory.peak)} at the "
        f"peak, with the compliance of pairs{' one by one' * memory.one_by_one}{about}{there}"
        f"{'' if enough else ', which is not enough'}"
    )


def _point(values: Iterable[float]) -> str:
    return f"({', '.join(f'{value + 0.0:.4g}' for value in values)})"


def _bodies(mesh: Mesh) -> Table:
    label, names = mesh.bodies, body_names(mesh)
    owners = [label[block.nodes[:, 0]] for block in mesh.blocks]
    owner = np.concatenate([*owners, np.empty(0, dtype=np.int64)])
    rows = []
    for number, name in enumerate(names):
        nodes = mesh.nodes[label == number]
        low, high = (_point(corner.tolist()) for corner in (nodes.min(axis=0), nodes.max(axis=0)))
        rows.append((name, len(nodes), int((owner == number).sum()), low, high))
    return text_table("Bodies", ["name", "nodes", "elements", "from", "to"], rows)


def _materials(assembly: Assembly) -> Table:
    owners = assembly.mesh.element_properties
    rows = [
        (
            number,
            material.name if material.law is None else f"{material.name} (anisotropic: means)",
            material.youngs_modulus,
            material.poissons_ratio,
            material.density,
            int((owners == number).sum()),
        )
        for number, material in assembly.materials.items()
    ]
    columns = ["property", "name", "E", "nu", "rho", "elements"]
    return text_table("Materials of solids", columns, rows)


def _connections(assembly: Assembly) -> Table:
    """Return the table of supports, couplings, springs and masses."""
    kinds = {
        **_supports(assembly),
        "rigid couplings (RBE2)": [
            len(connection.nodes) for connection in assembly.rigid_couplings
        ],
        "average couplings (RBE3)": [
            len(connection.nodes) for connection in assembly.average_couplings
        ],
        "equations (MPC)": [len(connection.terms) for connection in assembly.equations],
        "springs": [len(connection.ends) for connection in assembly.springs],
        "bushes": [len(connection.nodes) for connection in assembly.bushes],
        "point masses": [1 for _ in assembly.masses],
        "scalar masses": [len(connection.ends) for connection in assembly.scalar_masses],
    }
    rows = ((name, len(counts), sum(counts)) for name, counts in kinds.items() if counts)
    return text_table("Supports and couplings", ["kind", "number", "nodes or terms"], rows)


def _supports(assembly: Assembly) -> dict[str, list[int]]:
    """Return the node counts of the supports by their components."""
    ids: dict[str, list[int]] = {}
    for support in assembly.supports:
        names = " ".join(DISPLACEMENT_NAMES[component] for component in support.components)
        axes = "" if support.axes is None else ", in local axes"
        ids.setdefault(f"supports of {names}{axes}", []).append(len(support.nodes))
    return ids


def _interfaces(model: Model, title: str) -> Table:
    columns = ["name", "faces", "pairs", "points", "rule", "area", "of declared"]
    columns += ["mean gap", "penalty"]
    return text_table(title, columns, map(_interface, model.interfaces.values()))


def _friction(model: Model) -> Table:
    rows = (
        (name, law.friction, float(law.tangential_penalty))
        for name, law in model.contact.laws.items()
    )
    return text_table("Friction", ["interface", "coefficient", "tangential penalty"], rows)


def _sides(model: Model) -> Table:
    """Return the table of the bodies at both sides of each interface."""
    label = model.assembly.mesh.bodies
    names = np.array([*body_names(model.assembly.mesh), "matrices"])
    rows = (
        (
            name,
            *(", ".join(sorted({*names[label[side]]})) for side in interface.pairs.T),
            *_signs(interface),
        )
        for name, interface in model.interfaces.items()
    )
    columns = ["name", "minus", "plus", "normal, minus to plus", "contact points on"]
    return text_table("Sides of the interfaces", columns, rows)


def _signs(interface: Interface) -> tuple[str, str]:
    """Return the mean normal, and the side of the contact points, as texts."""
    mean = np.round(interface.weights @ interface.normals / interface.area, 4) + 0
    directions = "" if interface.flat else "several directions, on average "
    return directions + _point(
        mean.tolist()
    ), "both sides" if interface.coupling is None else "minus"


def _interface(interface: Interface) -> tuple[object, ...]:
    normal = interface.law.normal
    share = kept_share(interface.area, interface.declared_area)
    return (
        interface.name,
        sum(len(faces.minus) for faces in interface.faces),
        len(interface.pairs),
        interface.n_points,
        interface.quadrature,
        interface.area,
        "" if share is None else f"{share:.1%}",
        float(interface.weights @ interface.initial_gap) / interface.area,
        float(normal.penalty) if isinstance(normal, Penalty) else normal.name,
    )


def _bolts(study: Study, loaded: LoadedModel, model: Model) -> Table:
    columns = ["name", "tightened", "along", "stiffness EA/L", "preload", "said by"]
    rows = (
        (
            spec.name,
            _tightened(spec),
            _point(np.round(bolt_direction(model.assembly, spec), 4).tolist()),
            float(model.bolts[spec.name].stiffness),
            _force_of(loaded, spec.name),
            "the study" if spec.name in StudyBolts.of(study).forced else "the source",
        )
        for spec in loaded.bolts
    )
    return text_table("Bolts", columns, rows)


def _force_of(loaded: LoadedModel, name: str) -> object:
    """Return the preload of a bolt, or its initial force if it is locked at that."""
    locked = loaded.initial_forces.get(name)
    return loaded.preloads.get(name) if locked is None else f"initial {locked:.6g}"


def _tightened(spec: BoltSpec) -> str:
    """Return the elements, nodes or axis of a bolt as text."""
    if spec.elements is not None:
        ids = list(spec.elements)
        return f"element{'s' * (len(ids) > 1)} {listed(ids)}"
    if spec.nodes is not None:
        return f"nodes {spec.nodes[0]}, {spec.nodes[1]}"
    ends = " to ".join(_point(end) for end in spec.axis or ())
    return f"beam generated from {ends}"


def _deck_loads(study: Study, loaded: LoadedModel) -> Table:
    """Return the table of loads of the source, and of the load cases that apply them."""
    rows = (
        (
            name,
            len(load.nodes),
            *(float(force) for force in load.forces.sum(axis=0)[:3]),
            ", ".join(_users(study, name)) or "none",
            "yes" if name == loaded.source.selected_load else "",
        )
        for name, load in loaded.assembly.loads.items()
    )
    columns = ["name", "nodes", "sum Fx", "sum Fy", "sum Fz", "load cases", "selected by deck"]
    return text_table("Loads of the source", columns, rows)


def _users(study: Study, load: str) -> list[str]:
    return [
        case.name
        for case in study.load_cases
        if any(force.deck_load == load for force in case.forces)
    ]


def _unused_loads(study: Study, loaded: LoadedModel) -> Iterator[Table]:
    """Yield the study lines that apply the unused loads of the source."""
    unused = [name for name in loaded.assembly.loads if not _users(study, name)]
    unused.sort(key=lambda name: name != loaded.source.selected_load)
    if not unused:
        return
    lines = []
    for name in unused[:MOST_SHOWN]:
        text = quoted(name)
        lines += ["[[load_case]]", f"name = {json.dumps(_case_name(study, name))}"]
        lines += ['kind = "static"', f"forces = [{{ deck_load = {text}, value = 1.0 }}]", ""]
    title = "Loads of the source that no load case applies; to apply them, add to the study"
    yield text_table(title, ["TOML"], ([line] for line in lines[:-1]))


def _case_name(study: Study, load: str) -> str:
    """Return an unused name for a load case."""
    names = {case.name for case in study.load_cases}
    name = load if load.startswith("step") else f"load {load}"
    return f"{name} of the deck" if name in names else name


def _rigid_body_modes(parts: FreeParts) -> Table:
    """Return the table of rigid-body modes that only contact resists."""
    if parts.count is None:
        rows = [("not computed", "too many bodies and loose nodes")]
    else:
        whole = [("the whole", AS_A_WHOLE.format(count=parts.whole))] if parts.whole else []
        rows = [*parts.parts.items(), *whole] or [("none", "everything is held")]
    title = "Rigid-body modes, contact aside" + (f": {parts.count}" if parts.count else "")
    return text_table(title, ["what", "how"], rows)


def _boundary(boundary: Boundary) -> tuple[str, str, str]:
    nodes = np.unique(boundary.nodes).tolist()
    shown = ", ".join(map(str, nodes)) if len(nodes) <= 4 else f"{len(nodes)} nodes"
    components = [FORCE_NAMES[c] for c in np.unique(boundary.components)]
    return boundary.name, shown, " ".join(components)
