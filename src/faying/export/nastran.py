"""The linear export for Nastran: an external superelement with OP4 matrices, or DMIG cards.

Rows of all matrices are the *superelement's*: boundary grids in ascending order of id and
component, then one scalar point for every other generalized coordinate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from importlib.metadata import version
from pathlib import Path

import numpy as np

from faying._typing import Indices, Matrix, Vector
from faying.exceptions import refuse, refuse_study
from faying.export.linearized import LinearModel, linearize
from faying.io.dmig import dmig_text
from faying.io.nastran.fields import LARGEST_ID, Value, large, small
from faying.io.op4 import write_op4
from faying.joint.system import elongations, initial_bolt_forces
from faying.reduction.reduced_model import ReducedModel
from faying.study.results.values import Results

SUPERELEMENT = 100
"""Id of the superelement, and the Fortran unit of its OP4 file."""

FIRST_POINT = 1_000_001
"""Id of the first scalar point, if all grids have smaller ids."""

_AFTER = ("K4XX", "PA", "GPXX", "GDXX", "RVAX")
_OUTPUTS = ("MUG1", "MES1", "MEE1", "MGPF", "MEF1", "MQG1", "MQMG1")


@dataclass(frozen=True, eq=False, kw_only=True)
class Rows:
    """The rows of the superelement.

    Attributes
    ----------
    dofs : (n, 2)
        Grid id and component 1..6, or scalar point id and 0.
    order : (n,)
        Generalized coordinate q of each row.
    """

    dofs: Indices
    order: Indices

    @property
    def points(self) -> Indices:
        """Ids of the scalar points."""
        return np.asarray(self.dofs[self.dofs[:, 1] == 0, 0])

    @property
    def grids(self) -> dict[int, str]:
        """Components of each grid by id, such as "123456"."""
        grids: dict[int, str] = {}
        for grid, component in self.dofs[self.dofs[:, 1] > 0].tolist():
            grids[grid] = grids.get(grid, "") + str(component)
        return grids


def write(rom: ReducedModel, path: Path, _: Results | None = None) -> tuple[Path, ...]:
    """Write a superelement ``path`` (.op4) with .asm and .pch, or DMIG cards for a path .dmig.

    Recovery matrices (``_recovery.op4``) and an explanation are written beside them
    (``_readme.txt``).

    Raises
    ------
    FormatError
        If the path has another suffix, or ids leave no room for scalar points.
    StudyError
        If the run applies loads of its deck.

    Notes
    -----
    Sources of the layout: external superelement creation (EXTSEOUT) and SEBULK, SECONCT, EXTRN in
    the Nastran quick reference guides; the order of the matrices is as in pyYeti's
    ``wtextseout``. DMIG has at least ten digits, OP4 all.
    """
    _refuse_deck_loads(rom)
    linear, rows = linearize(rom), superelement_rows(rom)
    if path.suffix.lower() == ".op4":
        files = _write_superelement(rom, linear, rows, path)
    elif path.suffix.lower() == ".dmig":
        files = _write_dmig(rom, linear, rows, path)
    else:
        refuse(f"{path.name} ends in '{path.suffix}', expected .op4 or .dmig; change it")
    recovery, text = (path.with_name(path.stem + end) for end in ("_recovery.op4", "_readme.txt"))
    write_op4(recovery, recovery_matrices(rom, linear, rows))
    text.write_text(_readme(rom, rows, (*files, recovery)), encoding="utf-8")
    return (*files, recovery, text)


def superelement_rows(rom: ReducedModel) -> Rows:
    """Return the grid component or scalar point of each generalized coordinate."""
    boundaries = rom.boundaries.values()
    existing = {
        (int(node), int(component) + 1): int(row)
        for boundary in boundaries
        for node, component, row in zip(
            boundary.nodes, boundary.components, boundary.dofs, strict=True
        )
    }
    dofs = sorted(existing)
    outer = [existing[dof] for dof in dofs]
    inner = np.setdiff1d(np.arange(len(rom.K)), outer)
    first = max(FIRST_POINT, int(rom.mesh.node_ids.max(initial=0)) + 1)
    if first + len(inner) > LARGEST_ID:
        refuse(
            f"node ids reach {first - 1}, which leaves no room for {len(inner)} scalar points "
            f"below {LARGEST_ID + 1}; renumber the nodes"
        )
    points = [(first + number, 0) for number in range(len(inner))]
    return Rows(
        dofs=np.array([*dofs, *points], dtype=np.int64).reshape(-1, 2),
        order=np.array([*outer, *inner.tolist()], dtype=np.int64),
    )


def recovery_matrices(
    rom: ReducedModel, linear: LinearModel, rows: Rows
) -> dict[str, Matrix | Vector]:
    """Return the matrices from motion of the superelement to contact forces, gaps and pressures.

    Columns are the superelement's rows; the names are explained in the text written beside them.
    """
    order = rows.order
    contact, ports = rom.contact, rom.joint.port_compliance
    bolts = list(rom.bolts.values())
    matrices: dict[str, Matrix | Vector] = {
        "QREF": linear.state[order],
        "LAMROW": linear.force_rows[:, order],
        "LAM0": linear.force_offsets,
        "GAPROW": linear.gap_rows[:, order],
        "GAP0": linear.gap_offsets,
        "WEIGHT": contact.weights,
        "DLAW": contact.flexibility if contact.proportional else np.zeros(0),
        "GINIT": contact.initial_gap,
        "NINT": contact.interpolation.toarray(),
        "PREL": np.asarray(contact.relative_operator)[:, order],
        "RINERT": rom.recovery.inertia[:, order],
        "RDAMP": rom.recovery.damping[:, order],
        "RCOMPC": np.vstack([ports.relative, ports.contact_columns]),
        "RCOMPF": np.vstack([ports.contact_columns.T, ports.input_rows]),
        "BOLTE": elongations(rom.bolts, len(order))[:, order],
        "BOLTK": np.array([bolt.stiffness for bolt in bolts], dtype=float),
        "BOLTN0": initial_bolt_forces(rom),
    }
    return {name: matrix for name, matrix in matrices.items() if np.size(matrix)}


def _write_superelement(
    rom: ReducedModel, linear: LinearModel, rows: Rows, path: Path
) -> tuple[Path, ...]:
    title = f"{rom.name}, {rom.method}, faying {version('faying')}"
    places = _places(rom, rows)
    assembly, punch = path.with_suffix(".asm"), path.with_suffix(".pch")
    nothing = np.zeros((1, 1))
    write_op4(
        path,
        {
            **_ordered(linear, rows, "AA"),
            **dict.fromkeys(_AFTER, nothing),
            "VA": np.ones(len(rows.order)),
            **{name + end: nothing for name in _OUTPUTS for end in ("", "O")},
        },
    )
    assembly.write_text(assembly_cards(title, rows, places))
    punch.write_text(punch_cards(title, rows, places))
    return path, assembly, punch


def _write_dmig(rom: ReducedModel, linear: LinearModel, rows: Rows, path: Path) -> tuple[Path, ...]:
    grids = path.with_name(path.stem + "_grids.bdf")
    cards = [
        f"$ {rom.name}, {rom.method}, linear export of faying {version('faying')}\n"
        "$ Values have at least ten digits; the OP4 file of the same joint has all.\n",
        scalar_points(rows.points),
        *(
            dmig_text(name, matrix, rows.dofs)
            for name, matrix in _ordered(linear, rows, "AAX").items()
        ),
    ]
    path.write_text("".join(cards))
    grids.write_text(grid_cards(_places(rom, rows)))
    return path, grids


def _ordered(linear: LinearModel, rows: Rows, end: str) -> dict[str, Matrix]:
    block = np.ix_(rows.order, rows.order)
    matrices = {"K": linear.K, "M": linear.M, "B": linear.C}
    return {name + end: (matrix[block] + matrix[block].T) / 2 for name, matrix in matrices.items()}


def _places(rom: ReducedModel, rows: Rows) -> dict[int, Sequence[float]]:
    """Return the coordinates of each grid by id."""
    where = {int(node): row for row, node in enumerate(rom.mesh.node_ids.tolist())}
    return {grid: rom.mesh.nodes[where[grid]].tolist() for grid in rows.grids}


def _refuse_deck_loads(rom: ReducedModel) -> None:
    if rom.load_patterns:
        names = ", ".join(f"'{name}'" for name in rom.load_patterns)
        refuse_study(
            f"a Nastran superelement cannot apply the deck load {names} of this run; export to "
            "mat, npz, fmu or exudyn, or run the study without 'deck_load', with loads at a "
            "[[boundary]]"
        )


_MATRICES = """\
  QREF    state of the linearization (preload), one value per row
  LAMROW  change of the contact force at every contact point per row
  LAM0    contact forces at that state: lambda = LAM0 + LAMROW x, pressure = lambda / WEIGHT
  GAPROW, GAP0   the same for the gaps
  WEIGHT  area of every contact point
  DLAW    compliance of the contact law, 1 / (penalty x area); zero where contact is hard
  GINIT   initial gap of every contact point
  NINT    interpolation: gaps at contact points from relative displacements of the node pairs
  PREL    relative displacements of the node pairs per row
  RINERT, RDAMP  displacements at the ports per acceleration and per velocity of each row
  RCOMPC  displacements at the ports per relative force of each node pair
  RCOMPF  displacements at the ports per boundary force, then per bolt (a bolt pulls: use -N0)
  BOLTE, BOLTK, BOLTN0  elongation of the bolts per row, stiffness, initial force:
          bolt force = BOLTK (BOLTE (QREF + x)) + BOLTN0
Ports: node pairs, then boundary degrees of freedom boundary by boundary, then bolts.
A negative lambda or, where the joint was open, a negative gap shows that the linear joint is not
valid there: recover the pressures (faying recover, or the next lines).
Pressures of the full model at an instant with velocity v and acceleration a of the rows and
boundary forces f (mode acceleration with contact):
  free = RCOMPF [f; -BOLTN0] - RINERT a - RDAMP v
  solve  s = (NINT S NINT' + diag(DLAW)) lambda + GINIT + NINT free(pairs) >= 0, lambda >= 0,
  lambda' s = 0, with S the first rows of RCOMPC, one per node pair.
"""


_FRICTION = """
FRICTION: every point in contact at the preload sticks tangentially. The superelement is
valid as long as no point slips (faying gives the load of first slip: slip_onset_factor), is too
stiff beyond, and has no damping by slip: give modes the damping of a backbone.
The contact problem of the recovery below has no friction; recover pressures and tractions with
faying instead.
"""


_CURVES = """
CURVES: pressure over closure is a curve, whose slope at the preload the superelement has, a
gasket that of unloading. DLAW is left out and the contact problem of the recovery below does not
hold; recover pressures with faying instead.
"""


def _readme(rom: ReducedModel, rows: Rows, files: Sequence[Path]) -> str:
    """Return the explanation of files, rows and recovery matrices."""
    kinds = rom.basis.kinds
    lines = [
        f"{rom.name}: reduced model '{rom.method}' of faying {version('faying')}",
        f"Units: {rom.units}",
        "",
        "LINEAR export: the joint is linearized at its preloaded state. It neither opens nor",
        "closes. Displacements x are changes from that state; do not apply the bolt preload again.",
        _FRICTION if rom.contact.components > 1 else "",
        "" if rom.contact.proportional else _CURVES,
        f"Files: {', '.join(file.name for file in files)}",
        "How to attach them: docs/how-to/export_to_nastran.md of faying.",
        "",
        "Rows (grid or scalar point, component, generalized coordinate q counted from zero, kind):",
        *(
            f"{row + 1:7} {point:9} {component:2} {grid:7}  {kinds[grid]}"
            for row, ((point, component), grid) in enumerate(
                zip(rows.dofs.tolist(), rows.order.tolist(), strict=True)
            )
        ),
        "",
        "Matrices of the recovery file, columns in the order of these rows:",
        _MATRICES,
    ]
    return "\n".join(lines)


Places = Mapping[int, Sequence[float]]
"""Coordinates in the basic system by grid id."""


def assembly_cards(title: str, rows: Rows, places: Places) -> str:
    """Return the cards (.asm) for the main bulk data of the assembly run."""
    points = rows.points
    pairs: list[Value] = [grid for repeated in rows.grids for grid in (repeated, repeated)]
    # The pairs of equal ids begin on the second line.
    head: list[Value] = [SUPERELEMENT, 0, None, "NO", None, None, None, None]
    cards = [
        f"$ {title}",
        "$ Include in the main bulk data of the assembly run.",
        small("SEBULK", [SUPERELEMENT, "EXTOP4", None, "MANUAL", None, None, SUPERELEMENT]),
        small("SECONCT", [*head, *pairs]),
    ]
    if len(points):
        cards.append(small("SECONCT", [*head, *_run(points) * 2]))
    return "\n".join(cards) + "\n" + grid_cards(places) + scalar_points(points)


def punch_cards(title: str, rows: Rows, places: Places) -> str:
    """Return the section (.pch) for the end of the deck of the assembly run."""
    points = rows.points
    outer = [value for grid, components in rows.grids.items() for value in (grid, components)]
    inner = [value for point in points.tolist() for value in (point, 0)]
    cards = [
        f"$ {title}",
        "$ Include at the very end of the assembly run, after all other bulk data.",
        f"BEGIN SUPER{SUPERELEMENT:9}",
        small("EXTRN", [*outer, *inner]),
        *(small("ASET", outer[i : i + 8]) for i in range(0, len(outer), 8)),
    ]
    if len(points):
        cards.append(small("QSET1", [0, *_run(points)]))
    return "\n".join(cards) + "\n" + grid_cards(places) + scalar_points(points)


def grid_cards(places: Places) -> str:
    """Return GRID cards in sixteen columns."""
    return "".join(f"{large('GRID', [grid, 0, *xyz])}\n" for grid, xyz in places.items())


def scalar_points(points: Indices) -> str:
    """Return the SPOINT card of consecutive points; empty without points."""
    return small("SPOINT", _run(points)) + "\n" if len(points) else ""


def _run(points: Indices) -> list[Value]:
    first, last = int(points[0]), int(points[-1])
    return [first, "THRU", last] if last > first else [first]
