"""Tighten a gasketed flange of eight bolts by a plan and without, by faying and by CalculiX.

``python docs/validation/tightening_flange.py FOLDER`` (``pip install gmsh``; ``ccx`` must be
installed) meshes the flange of judged_by_hand.py with a compressed sheet between its faces, writes
the study, plans as ``faying tighten`` does, and lets CalculiX pull the bolts one after the other:
once to their preload, and by the plan. Prints the table of docs/theory/bolts_and_sticking.md. Some
minutes, most of them CalculiX's.
"""

import os
import re
import subprocess
import sys
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
from judged_by_hand import FLANGE, YOUNGS, flange_places, mesh_flange

from faying._typing import Matrix
from faying.io.abaqus.writer import write_deck
from faying.model.description import JointDescription
from faying.model.generated_bolt import add_bolt
from faying.study.inputs.load_model import load_model
from faying.study.keys.schema import read_study
from faying.workflow.tighten import plan_of_study

PRELOAD = 30e3
STAR = (1, 5, 3, 7, 2, 6, 4, 8)
"""Order of the turns."""

SHEET = 50.0
"""Pressure over closure of the sheet [MPa/mm]: 2 mm of 100 MPa."""

STEP = """\
*STEP,INC=100
*STATIC,DIRECT
1.,1.
*CONTROLS,PARAMETERS=FIELD
1e-6,1e-6,,,1e-6
"""


def written_study(folder: Path) -> Path:
    """Write mesh and study."""
    mesh_flange(folder / "gasketed.msh", size=24.0, around=6)
    text = f"""title = "Gasketed flange"
units = "mm-t-s"

[model]
source = "mesh"
file = "gasketed.msh"
separate = ["upper"]

[material.default]
E = {YOUNGS}
nu = 0.3
rho = 7.85e-9

[[interface]]
name = "sheet"
minus = "lower"
plus = "upper"
penalty = {SHEET}

[[support]]
set = "clamp"
"""
    places = flange_places()
    for number in STAR:
        x, y = places[number - 1]
        text += f"""
[[bolt]]
name = "bolt-{number}"
axis = [[{x:.4f}, {y:.4f}, {-FLANGE["thick"]}], [{x:.4f}, {y:.4f}, {FLANGE["thick"]}]]
size = "M12"
preload = {PRELOAD}
"""
    path = folder / "gasketed.toml"
    path.write_text(text)
    return path


def written_deck(study: Path, path: Path) -> None:
    """Write the same joint for CalculiX."""
    loaded = load_model(read_study(study))
    assembly, bolts = loaded.assembly, []
    for spec in loaded.bolts:
        assembly = add_bolt(assembly, spec)
        bolts.append(replace(spec, elements=(assembly.beams[-1].id,), axis=None))
    description = JointDescription(
        assembly=assembly,
        interfaces=loaded.interfaces,
        bolts=tuple(bolts),
        preloads=loaded.preloads,
    )
    write_deck(description, path)


def tightened(study: Path, settings: Mapping[str, float], waiting: Matrix, path: Path) -> Matrix:
    """Return the forces (n_turn, n_bolt) after each turn by CalculiX, in the order of turns.

    Each bolt is pulled with its setting while those before it are fixed. A nut that waits its turn
    is finger-tight: it is fixed too where it pulls (n_turn, n_bolt), and loose where it would push.
    """
    written_deck(study, path)
    head, steps = path.read_text().split("** preload\n")
    nodes = dict(zip(settings, re.findall(r"^(\d+),1,[\d.e+]+$", steps, re.M), strict=True))
    supports = "".join(re.findall(r"^\*BOUNDARY\n((?:[^*].*\n)+)", head, re.M))
    text = f"{head}*NSET,NSET=SECTIONS\n{','.join(nodes.values())}\n"
    names = list(settings)
    for turn, bolt in enumerate(names):
        pulls = (n for n, force in zip(names, waiting[turn], strict=True) if force > 0)
        loose = "".join(f"{nodes[n]},1\n" for n in pulls if n in names[turn + 1 :])
        text += f"{STEP}*BOUNDARY,OP=NEW\n{supports}{loose}"
        if turn:
            text += "*BOUNDARY,FIXED\n" + "".join(f"{nodes[n]},1\n" for n in names[:turn])
        text += f"*CLOAD,OP=NEW\n{nodes[bolt]},1,{settings[bolt]!r}\n"
        text += "*NODE PRINT,NSET=SECTIONS\nRF\n*END STEP\n"
    path.write_text(text)
    command = ["ccx", path.stem]
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    subprocess.run(command, cwd=path.parent, check=True, capture_output=True, env=environment)
    found = []
    for part in path.with_suffix(".dat").read_text().split(" forces (fx,fy,fz)")[1:]:
        rows = [line.split() for line in part.splitlines()]
        forces = {row[0]: float(row[1]) for row in rows if len(row) == 4}
        found.append([forces[nodes[bolt]] for bolt in settings])
    return np.array(found)


def main() -> None:
    """Print the forces that both ways leave."""
    folder = Path(sys.argv[1])
    folder.mkdir(exist_ok=True)
    study = written_study(folder)
    plan = plan_of_study(read_study(study))
    targets = dict(plan.targets)
    settings = dict(zip(plan.turned, plan.settings.tolist(), strict=True))
    columns = [plan.bolts.index(bolt) for bolt in targets]
    straight = tightened(study, targets, plan.unplanned[:, columns], folder / "straight.inp")
    planned = tightened(study, settings, plan.bolt_forces[:, columns], folder / "planned.inp")
    rows = (
        ("one pass straight to the preload", plan.unplanned[-1, columns], straight[-1]),
        ("by the plan", plan.bolt_forces[-1, columns], planned[-1]),
    )
    sys.stdout.write("| | faying | CalculiX |\n|---|---|---|\n")
    for name, ours, theirs in rows:
        cells = (f"{f.min() / PRELOAD:.2%} to {f.max() / PRELOAD:.2%}" for f in (ours, theirs))
        sys.stdout.write("| " + " | ".join((name, *cells)) + " |\n")
    off = max(
        np.abs(straight - plan.unplanned[:, columns]).max(),
        np.abs(planned - plan.bolt_forces[:, columns]).max(),
    )
    shares = plan.settings / PRELOAD
    sys.stdout.write(
        f"The plan sets the bolts to {shares.min():.1%} to {shares.max():.1%} of the preload; over "
        f"all turns and bolts both programs differ by {off / PRELOAD:.2%} of it at most.\n"
    )


if __name__ == "__main__":
    main()
